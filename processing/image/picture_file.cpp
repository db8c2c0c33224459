// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/picture_file.h"

#include <bit>

#include "processing/image/alpha.h"
#include "processing/image/codecs.h"
#include "processing/image/dng_file.h"
#include "processing/image/encoding.h"
#include "processing/image/linear_png.h"

namespace patina {
namespace {

codecs::Samples decodeSamples(std::span<const std::byte> file, const PictureHeader& header) {
  switch (header.format) {
    case PictureFormat::kJpeg:
      return codecs::decodeJpeg(file, header);
    case PictureFormat::kPng:
      return codecs::decodePng(file, header);
    case PictureFormat::kTiff:
      return codecs::decodeTiff(file, header);
    default:
      return codecs::decodeExr(file, header);
  }
}

template <class T>
double shareAtTop(const std::vector<T>& samples) {
  std::size_t n = 0;
  for (T v : samples) n += v == std::numeric_limits<T>::max() ? 1 : 0;
  return samples.empty() ? 0 : static_cast<double>(n) / static_cast<double>(samples.size());
}

Image<float> linearOf(Image<float> samples) { return samples; }
template <class T>
Image<float> linearOf(const Image<T>& samples) {
  return decodeSrgb(samples.view());
}

template <class T>
Image<float> scaled(const Image<T>& samples) {
  constexpr float kStep = 1.0f / std::numeric_limits<T>::max();
  Image<float> out(samples.width(), samples.height(), samples.channels());
  for (std::size_t i = 0; i < samples.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(samples.texels()[i]) * kStep;
  return out;
}

Picture pictureOfRaw(std::span<const std::byte> file, PictureFormat format,
                     const PictureLimits& limits) {
  const RawMosaic raw = decodeRaw(file, limits);
  std::size_t saturated = 0;
  for (std::uint16_t v : raw.samples.texels()) saturated += v >= raw.white_level ? 1 : 0;
  Picture out;
  out.linear = demosaic(raw);
  out.format = format;
  out.bits = std::bit_width(static_cast<unsigned>(raw.white_level));
  out.saturated_fraction =
      static_cast<double>(saturated) / static_cast<double>(raw.samples.texels().size());
  return out;
}

}  // namespace

std::string extensionOf(PictureFormat format) {
  switch (format) {
    case PictureFormat::kJpeg:
      return "jpg";
    case PictureFormat::kPng:
      return "png";
    case PictureFormat::kTiff:
      return "tif";
    case PictureFormat::kExr:
      return "exr";
    case PictureFormat::kDng:
      return "dng";
    case PictureFormat::kRaw:
      return "raw";
    case PictureFormat::kUnknown:
      break;
  }
  return "bin";
}

PictureHeader readPictureHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  if (file.empty()) codecs::refuse("the file is empty (0 bytes): copy it again");
  const PictureFormat format = sniffFormat(file);
  PictureHeader header;
  switch (format) {
    case PictureFormat::kJpeg:
      return codecs::readJpegHeader(file, limits);
    case PictureFormat::kPng:
      return codecs::readPngHeader(file, limits);
    case PictureFormat::kTiff:
      return codecs::readTiffHeader(file, limits);
    case PictureFormat::kExr:
      return codecs::readExrHeader(file, limits);
    case PictureFormat::kDng:
    case PictureFormat::kRaw:
      header = codecs::readRawHeader(file, limits);
      header.format = format;
      return header;
    case PictureFormat::kUnknown:
      break;
  }
  codecs::refuse(
      "not a picture: its first bytes are of no known format (JPEG, PNG, TIFF, EXR, DNG or a "
      "camera's raw), whatever its name says");
}

Image<float> decodeAlpha(std::span<const std::byte> file, const PictureLimits& limits) {
  const PictureFormat format = sniffFormat(file);
  if (format == PictureFormat::kPng) return codecs::decodePngAlpha(file, limits);
  if (format == PictureFormat::kExr) return codecs::decodeExrAlpha(file, limits);
  return {};
}

Picture decodePicture(std::span<const std::byte> file, const PictureLimits& limits) {
  const PictureFormat format = sniffFormat(file);
  if (format == PictureFormat::kDng || format == PictureFormat::kRaw)
    return pictureOfRaw(file, format, limits);
  const PictureHeader header = readPictureHeader(file, limits);
  Picture out;
  out.format = header.format;
  out.bits = header.bits;
  const bool linear = format == PictureFormat::kPng && isLinearPng(file);
  std::visit(
      [&](auto samples) {
        using T = typename std::decay_t<decltype(samples.texels())>::value_type;
        if constexpr (std::is_integral_v<T>) {
          out.saturated_fraction = shareAtTop(samples.texels());
          if (linear) {
            out.linear = scaled(samples);
            return;
          }
        }
        out.linear = linearOf(std::move(samples));
      },
      decodeSamples(file, header));
  return out;
}

Picture readPicture(const std::filesystem::path& path, const PictureLimits& limits) {
  const Bytes file = readFile(path, 4'294'967'296);
  try {
    return decodePicture(file, limits);
  } catch (const ProcessingError& e) {
    throw ProcessingError(e.exit(), path.string() + ": " + e.what());
  }
}

void writePng(const std::filesystem::path& path, ImageView<const std::uint8_t> srgb) {
  writeFileAtomically(path, encodePng(srgb));
}

void writeExr(const std::filesystem::path& path, ImageView<const float> linear) {
  writeFileAtomically(path, codecs::encodeExr(linear));
}

}  // namespace patina
