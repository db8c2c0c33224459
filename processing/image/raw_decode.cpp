// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/raw_decode.h"

#include <libraw/libraw.h>

#include <cstring>

#include "processing/image/codecs.h"
#include "processing/image/metadata_file.h"

namespace patina {
namespace {

// By its first bytes: DNG, and the raw formats of many cameras.
bool isTiff(std::span<const std::byte> file) {
  return file.size() >= 4 &&
         (std::memcmp(file.data(), "II*", 4) == 0 || std::memcmp(file.data(), "MM\0*", 4) == 0);
}

// LibRaw 0.20.2 trusts what a TIFF's directory says of its values.
void open(LibRaw& raw, std::span<const std::byte> file) {
  if (isTiff(file)) codecs::checkTiffValues(file);
  raw.imgdata.params.use_camera_wb = 0;
  raw.imgdata.params.no_auto_bright = 1;
  raw.set_dataerror_handler(nullptr, nullptr);  // its default prints on stderr
  const int error = raw.open_buffer(const_cast<std::byte*>(file.data()), file.size());
  if (error != LIBRAW_SUCCESS)
    codecs::refuse(std::string("the raw file cannot be read (") + libraw_strerror(error) +
                   "): it is damaged, truncated or of an unknown camera");
}

PictureHeader headerOf(const LibRaw& raw) {
  const auto& sizes = raw.imgdata.sizes;
  return {.format = PictureFormat::kRaw,
          .size = {sizes.width, sizes.height},
          .channels = 3,
          .bits = static_cast<int>(raw.imgdata.color.raw_bps)};
}

void readColours(LibRaw& raw, RawMosaic& out) {
  const auto& id = raw.imgdata.idata;
  for (int i = 0; i < 4; ++i) {
    const char colour = id.cdesc[raw.COLOR(i / 2, i % 2)];
    if (!std::strchr("RGB", colour) || colour == 0)
      codecs::refuse("the raw file's colour filters are not red, green and blue");
    out.cfa[i] = colour == 'R' ? 0 : colour == 'G' ? 1 : 2;
  }
}

void readLevels(const LibRaw& raw, RawMosaic& out) {
  const auto& colour = raw.imgdata.color;
  // The common level, and the mean of what differs within the repeated cell or by channel.
  const unsigned rows = colour.cblack[4], columns = colour.cblack[5];
  double extra = 0;
  for (int c = 0; c < 4; ++c) extra += colour.cblack[c] / 4.0;
  if (rows * columns > 0 && rows * columns <= LIBRAW_CBLACK_SIZE - 6)
    for (unsigned i = 0; i < rows * columns; ++i)
      extra += colour.cblack[6 + i] / double(rows * columns);
  out.black_level = colour.black + extra;
  out.white_level = colour.maximum;
}

}  // namespace

namespace codecs {

PictureHeader readRawHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  auto raw = std::make_unique<LibRaw>();
  open(*raw, file);
  const PictureHeader header = headerOf(*raw);
  checkClaim(header, limits);
  return header;
}

}  // namespace codecs

RawMosaic decodeRawByLibRaw(std::span<const std::byte> file, const PictureLimits& limits) {
  auto raw = std::make_unique<LibRaw>();  // half a megabyte: not for the stack
  open(*raw, file);
  const auto& sizes = raw->imgdata.sizes;
  codecs::checkClaim(headerOf(*raw), limits);
  const int error = raw->unpack();
  if (error != LIBRAW_SUCCESS)
    codecs::refuse(std::string("the raw samples cannot be read (") + libraw_strerror(error) +
                   "): the file is damaged or truncated; copy it again");
  const std::uint16_t* samples = raw->imgdata.rawdata.raw_image;
  if (!samples || raw->imgdata.idata.filters <= 1000)
    codecs::refuse("the raw file has no mosaic of 2x2 colour filters: convert it to TIFF");
  if (sizes.left_margin + sizes.width > sizes.raw_width ||
      sizes.top_margin + sizes.height > sizes.raw_height)
    codecs::refuse("the raw file's margins are damaged");
  RawMosaic out;
  readColours(*raw, out);
  readLevels(*raw, out);
  out.samples = Image<std::uint16_t>(sizes.width, sizes.height, 1);
  const std::size_t pitch = sizes.raw_pitch / sizeof(std::uint16_t);
  for (int y = 0; y < sizes.height; ++y)
    std::copy_n(samples + (y + sizes.top_margin) * pitch + sizes.left_margin, sizes.width,
                out.samples.view().row(y));
  const PictureMetadata said = readMetadata(file);
  const auto& other = raw->imgdata.other;
  out.exposure = said.exposure;
  out.iso = said.iso;
  out.f_number = said.f_number;
  out.taken_utc = said.taken_utc;
  if (!out.exposure && other.shutter > 0) out.exposure = fromSeconds(other.shutter);
  if (!out.iso && other.iso_speed > 0) out.iso = Iso{other.iso_speed};
  if (!out.f_number && other.aperture > 0) out.f_number = FNumber{other.aperture};
  out.make = raw->imgdata.idata.make;
  out.model = raw->imgdata.idata.model;
  return out;
}

RawMosaic decodeRaw(std::span<const std::byte> file, const PictureLimits& limits) {
  if (isTiff(file)) codecs::checkTiffValues(file);
  if (auto own = decodeOwnDng(file, limits)) return std::move(*own);
  return decodeRawByLibRaw(file, limits);
}

}  // namespace patina
