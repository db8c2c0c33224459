// SPDX-License-Identifier: GPL-3.0-or-later
// DNG out, and the quick way back in for what this file wrote. Layout: one IFD, one strip of
// 16-bit samples, and an EXIF directory.
#include "processing/image/dng_file.h"

#include <tiff.h>

#include <array>
#include <cmath>
#include <cstring>

#include "processing/image/codecs.h"
#include "processing/image/exif_directory.h"
#include "processing/image/plain_tiff.h"
#include "processing/image/raw_decode.h"

namespace patina {
namespace {

constexpr std::uint16_t kCfa = 32803;
constexpr char kSoftware[] = "Patina";
constexpr std::size_t kDirectoriesBytes = 1024;  // about; EXIF's and the main one, with values

void check(const RawMosaic& raw) {
  const bool good =
      !raw.samples.empty() && raw.samples.channels() == 1 && raw.white_level >= 1 &&
      raw.white_level <= 65535 && raw.black_level >= 0 && raw.black_level < raw.white_level &&
      raw.samples.texels().size() * 2 < UINT32_MAX - 65'536 &&
      (!raw.exposure || raw.exposure->count() > 0) &&
      (!raw.f_number || (raw.f_number->value >= 0.1 && raw.f_number->value <= 10'000)) &&
      (!raw.iso || (raw.iso->value >= 1 && raw.iso->value <= 65535)) &&
      *std::max_element(raw.cfa.begin(), raw.cfa.end()) <= 2;
  if (!good)
    throw ProcessingError(Exit::kUsage,
                          "DNG: one plane of samples, less than 4 GiB, 0 <= black < white <= "
                          "65535, exposure above 0, "
                          "ISO 1 to 65535, colours 0 to 2");
}

std::uint32_t rounded(double v) { return static_cast<std::uint32_t>(std::lround(v)); }

// A level below 65536 exactly, to the digits of a float.
TiffRational rationalOf(float level) {
  std::uint32_t bottom = 1;
  while (level != std::floor(level) && bottom < 1u << 16) {
    level *= 2;
    bottom *= 2;
  }
  return {static_cast<std::uint32_t>(level), bottom};
}

std::optional<double> valueOf(std::optional<TiffRational> r) {
  if (!r || r->top == 0 || r->bottom == 0) return std::nullopt;
  return static_cast<double>(r->top) / static_cast<double>(r->bottom);
}

void describeSamples(TiffDirectoryWriter& main, const RawMosaic& raw, std::uint32_t offset) {
  const auto height = static_cast<std::uint32_t>(raw.samples.height());
  main.number(TIFFTAG_SUBFILETYPE, TiffType::kLong, 0);
  main.size(TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(raw.samples.width()));
  main.size(TIFFTAG_IMAGELENGTH, height);
  main.shorts(TIFFTAG_BITSPERSAMPLE, {16});
  main.shorts(TIFFTAG_SAMPLESPERPIXEL, {1});
  main.shorts(TIFFTAG_COMPRESSION, {COMPRESSION_NONE});
  main.shorts(TIFFTAG_PHOTOMETRIC, {kCfa});
  main.shorts(TIFFTAG_PLANARCONFIG, {PLANARCONFIG_CONTIG});
  main.shorts(TIFFTAG_ORIENTATION, {ORIENTATION_TOPLEFT});
  main.size(TIFFTAG_ROWSPERSTRIP, height);
  main.number(TIFFTAG_STRIPOFFSETS, TiffType::kLong, offset);
  main.number(TIFFTAG_STRIPBYTECOUNTS, TiffType::kLong,
              static_cast<std::uint32_t>(raw.samples.texels().size() * 2));
}

void describeCamera(TiffDirectoryWriter& main, const RawMosaic& raw) {
  const std::string make = raw.make.empty() ? "Patina" : raw.make;
  const std::string model = raw.model.empty() ? "Camera" : raw.model;
  main.text(TIFFTAG_MAKE, make);
  main.text(TIFFTAG_MODEL, model);
  main.text(TIFFTAG_SOFTWARE, kSoftware);
  main.text(TIFFTAG_UNIQUECAMERAMODEL, make + " " + model);
  main.bytes(TIFFTAG_DNGVERSION, std::array<std::uint8_t, 4>{1, 4, 0, 0});
  main.bytes(TIFFTAG_DNGBACKWARDVERSION, std::array<std::uint8_t, 4>{1, 1, 0, 0});
  main.shorts(TIFFTAG_CFAREPEATPATTERNDIM, {2, 2});
  main.bytes(TIFFTAG_CFAPATTERN, raw.cfa);
  main.bytes(TIFFTAG_CFAPLANECOLOR, std::array<std::uint8_t, 3>{0, 1, 2});
  main.shorts(TIFFTAG_CFALAYOUT, {1});
  const TiffRational black = rationalOf(static_cast<float>(raw.black_level));
  main.rationals(TIFFTAG_BLACKLEVEL, TiffType::kRational, {&black, 1});
  main.number(TIFFTAG_WHITELEVEL, TiffType::kLong, rounded(raw.white_level));
  // Camera colours are taken as XYZ, unbalanced: calibration decides later, not the file.
  const TiffRational nil{0, 1}, one{1, 1};
  main.rationals(TIFFTAG_COLORMATRIX1, TiffType::kSignedRational,
                 std::array{one, nil, nil, nil, one, nil, nil, nil, one});
  main.shorts(TIFFTAG_CALIBRATIONILLUMINANT1, {21});  // D65
  main.rationals(TIFFTAG_ASSHOTNEUTRAL, TiffType::kRational, std::array{one, one, one});
}

void readExif(std::span<const std::byte> file, std::uint32_t offset, RawMosaic& out) {
  const auto exif = TiffDirectory::at(file, offset);
  if (!exif) codecs::refuse("the DNG is damaged: its EXIF");
  if (const auto s = valueOf(exif->rational(EXIFTAG_EXPOSURETIME))) out.exposure = fromSeconds(*s);
  if (const auto f = valueOf(exif->rational(EXIFTAG_FNUMBER))) out.f_number = FNumber{*f};
  if (const auto iso = exif->number(EXIFTAG_ISOSPEEDRATINGS))
    out.iso = Iso{static_cast<double>(*iso)};
  out.serial = exif->text(kBodySerialNumber);
  std::string date = exif->text(EXIFTAG_DATETIMEORIGINAL);
  if (date.size() != 19) return;
  date[4] = date[7] = '-';
  try {
    out.taken_utc = parseUtc(date + "." + exif->text(EXIFTAG_SUBSECTIMEORIGINAL) + "Z");
  } catch (const ProcessingError&) {
    codecs::refuse("the DNG is damaged: its date");
  }
}

// Whether it is of the one kind that encodeDng writes.
bool isOurs(const TiffDirectory& main) {
  return main.text(TIFFTAG_SOFTWARE) == kSoftware && main.number(TIFFTAG_PHOTOMETRIC) == kCfa &&
         main.number(TIFFTAG_BITSPERSAMPLE) == 16 && main.number(TIFFTAG_SAMPLESPERPIXEL) == 1 &&
         main.number(TIFFTAG_COMPRESSION) == COMPRESSION_NONE && !main.has(TIFFTAG_TILEWIDTH);
}

}  // namespace

Bytes encodeDng(const RawMosaic& raw) {
  check(raw);
  const auto samples = std::as_bytes(std::span(raw.samples.texels()));
  Bytes file;
  file.reserve(samples.size() + kDirectoriesBytes);
  for (const char byte : {'I', 'I', '\x2a', '\0', '\0', '\0', '\0', '\0'})
    file.push_back(static_cast<std::byte>(byte));
  const std::uint32_t exif = appendExif(file, {.exposure = raw.exposure,
                                               .iso = raw.iso,
                                               .f_number = raw.f_number,
                                               .taken_utc = raw.taken_utc,
                                               .make = {},
                                               .model = {},
                                               .serial = raw.serial});
  const auto offset = static_cast<std::uint32_t>(file.size());
  file.insert(file.end(), samples.begin(), samples.end());
  TiffDirectoryWriter main;
  describeSamples(main, raw, offset);
  describeCamera(main, raw);
  if (exif != 0) main.number(TIFFTAG_EXIFIFD, TiffType::kDirectory, exif);
  const std::uint32_t first = main.appendTo(file);
  std::memcpy(file.data() + 4, &first, sizeof first);
  return file;
}

std::optional<RawMosaic> decodeOwnDng(std::span<const std::byte> file,
                                      const PictureLimits& limits) {
  if (sniffFormat(file) != PictureFormat::kDng) return std::nullopt;
  const auto main = TiffDirectory::first(file);
  if (!main || !isOurs(*main)) return std::nullopt;
  const auto width = main->number(TIFFTAG_IMAGEWIDTH).value_or(0);
  const auto height = main->number(TIFFTAG_IMAGELENGTH).value_or(0);
  if (width > 65535 || height > 65535)
    codecs::refuse("the DNG claims more than 65535 pixels a side");
  codecs::checkClaim({.format = PictureFormat::kDng,
                      .size = {static_cast<int>(width), static_cast<int>(height)},
                      .channels = 3,
                      .bits = 16},
                     limits);
  const auto offset = main->number(TIFFTAG_STRIPOFFSETS);
  const auto bytes = main->number(TIFFTAG_STRIPBYTECOUNTS);
  const auto cfa = main->value(TIFFTAG_CFAPATTERN, TiffType::kByte, 4);
  const auto black = main->rational(TIFFTAG_BLACKLEVEL);
  const auto white = main->number(TIFFTAG_WHITELEVEL);
  if (!offset || !bytes || cfa.empty() || !black || black->bottom == 0 || !white)
    return std::nullopt;
  if (*bytes != std::uint64_t{width} * height * 2 || *offset > file.size() ||
      *bytes > file.size() - *offset)
    codecs::refuse("the DNG is truncated: its samples lie beyond the end; copy it again");

  RawMosaic out;
  std::memcpy(out.cfa.data(), cfa.data(), out.cfa.size());
  out.black_level = static_cast<float>(static_cast<double>(black->top) / black->bottom);
  out.white_level = *white;
  out.make = main->text(TIFFTAG_MAKE);
  out.model = main->text(TIFFTAG_MODEL);
  out.samples = Image<std::uint16_t>(static_cast<int>(width), static_cast<int>(height), 1);
  std::memcpy(out.samples.texels().data(), file.data() + *offset, *bytes);
  if (const auto exif = main->number(TIFFTAG_EXIFIFD)) readExif(file, *exif, out);
  return out;
}

}  // namespace patina
