// SPDX-License-Identifier: GPL-3.0-or-later
// DNG out, and the quick way back in for what this file wrote. Layout: one IFD, one strip of
// 16-bit samples, and an EXIF directory.
#include "processing/image/dng_file.h"

#include <tiffio.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>

#include "processing/image/codecs.h"
#include "processing/image/memory_tiff.h"
#include "processing/image/raw_decode.h"

namespace patina {
namespace {

constexpr std::uint16_t kCfa = 32803;
constexpr char kSoftware[] = "Patina";

struct ExifTime {
  char date[20] = "";      // 2024:05:01 12:00:00
  char fraction[10] = "";  // nanoseconds, nine digits
};

ExifTime exifTime(UtcTime t) {
  ExifTime out;
  const std::string text = formatUtc(t);  // 2024-05-01T12:00:00.000Z
  std::copy_n(text.begin(), 19, out.date);
  out.date[4] = out.date[7] = ':';
  out.date[10] = ' ';
  const auto ns = (t - std::chrono::floor<std::chrono::seconds>(t)).count();
  std::snprintf(out.fraction, sizeof out.fraction, "%09d", static_cast<int>(ns));
  return out;
}

void check(const RawMosaic& raw) {
  const bool good =
      !raw.samples.empty() && raw.samples.channels() == 1 && raw.white_level >= 1 &&
      raw.white_level <= 65535 && raw.black_level >= 0 && raw.black_level < raw.white_level &&
      (!raw.exposure || raw.exposure->count() > 0) &&
      (!raw.f_number || (raw.f_number->value >= 0.1 && raw.f_number->value <= 10'000)) &&
      (!raw.iso || (raw.iso->value >= 1 && raw.iso->value <= 65535)) &&
      *std::max_element(raw.cfa.begin(), raw.cfa.end()) <= 2;
  if (!good)
    throw ProcessingError(
        Exit::kUsage,
        "DNG: one plane of samples, 0 <= black < white <= 65535, exposure above 0, "
        "ISO 1 to 65535, colours 0 to 2");
}

// libtiff passes rationals through float, which loses nanoseconds of a long exposure: where a
// rational of the EXIF directory at `ifd` lies in a little-endian file, or nothing.
std::optional<std::size_t> findRational(std::span<const std::byte> file, std::uint64_t ifd,
                                        std::uint16_t tag) {
  const auto number = [&](std::uint64_t at, int bytes) {
    std::uint32_t v = 0;
    for (int i = 0; i < bytes; ++i) v |= std::to_integer<std::uint32_t>(file[at + i]) << (8 * i);
    return v;
  };
  if (ifd + 2 > file.size()) return std::nullopt;
  for (std::uint64_t i = 0, n = number(ifd, 2); i < n; ++i) {
    const std::uint64_t entry = ifd + 2 + 12 * i;
    if (entry + 12 > file.size()) break;
    if (number(entry, 2) != tag) continue;
    const std::uint64_t at = number(entry + 8, 4);
    if (number(entry + 2, 2) != TIFF_RATIONAL || at + 8 > file.size()) break;
    return at;
  }
  return std::nullopt;
}

std::optional<double> rationalAt(std::span<const std::byte> file, std::uint64_t ifd,
                                 std::uint16_t tag) {
  const auto at = findRational(file, ifd, tag);
  std::uint32_t parts[2] = {0, 0};
  if (at) std::memcpy(parts, file.data() + *at, 8);
  if (parts[0] == 0 || parts[1] == 0) return std::nullopt;
  return static_cast<double>(parts[0]) / static_cast<double>(parts[1]);
}

// top / bottom, coarser where 32 bits do not hold it (nanoseconds above 4.29 s).
void writeRational(Bytes& file, std::uint64_t ifd, std::uint16_t tag, std::int64_t top,
                   std::int64_t bottom) {
  const auto at = findRational(file, ifd, tag);
  PATINA_CHECK(at.has_value());
  const std::int64_t common = std::gcd(top, bottom);
  top /= common;
  bottom /= common;
  for (; top > UINT32_MAX; top /= 10) bottom = std::max<std::int64_t>(bottom / 10, 1);
  const std::uint32_t parts[2] = {static_cast<std::uint32_t>(top),
                                  static_cast<std::uint32_t>(bottom)};
  std::memcpy(file.data() + *at, parts, 8);
}

// Offset of the EXIF directory; 0 when there is nothing to say.
std::uint64_t writeExif(TIFF* tiff, const RawMosaic& raw) {
  if (!raw.exposure && !raw.f_number && !raw.iso && !raw.taken_utc) return 0;
  TIFFCreateEXIFDirectory(tiff);
  if (raw.exposure) TIFFSetField(tiff, EXIFTAG_EXPOSURETIME, toSeconds(*raw.exposure));
  if (raw.f_number) TIFFSetField(tiff, EXIFTAG_FNUMBER, raw.f_number->value);
  if (raw.iso) {
    const std::uint16_t iso[1] = {static_cast<std::uint16_t>(std::lround(raw.iso->value))};
    TIFFSetField(tiff, EXIFTAG_ISOSPEEDRATINGS, 1, iso);
  }
  if (raw.taken_utc) {
    const ExifTime time = exifTime(*raw.taken_utc);
    TIFFSetField(tiff, EXIFTAG_DATETIMEORIGINAL, time.date);
    TIFFSetField(tiff, EXIFTAG_SUBSECTIMEORIGINAL, time.fraction);
    TIFFSetField(tiff, EXIFTAG_OFFSETTIMEORIGINAL, "+00:00");
  }
  std::uint64_t offset = 0;
  TIFFWriteCustomDirectory(tiff, &offset);
  return offset;
}

void describeSamples(TIFF* tiff, const RawMosaic& raw) {
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, raw.samples.width());
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, raw.samples.height());
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kCfa);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, raw.samples.height());
}

void describeCamera(TIFF* tiff, const RawMosaic& raw) {
  const std::string make = raw.make.empty() ? "Patina" : raw.make;
  const std::string model = raw.model.empty() ? "Camera" : raw.model;
  TIFFSetField(tiff, TIFFTAG_MAKE, make.c_str());
  TIFFSetField(tiff, TIFFTAG_MODEL, model.c_str());
  TIFFSetField(tiff, TIFFTAG_SOFTWARE, kSoftware);
  TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, (make + " " + model).c_str());
  TIFFSetField(tiff, TIFFTAG_DNGVERSION, "\1\4\0\0");
  TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, "\1\1\0\0");
  const std::uint16_t cell[2] = {2, 2};
  TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, cell);
  TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, raw.cfa.data());
  TIFFSetField(tiff, TIFFTAG_CFAPLANECOLOR, 3, "\0\1\2");
  TIFFSetField(tiff, TIFFTAG_CFALAYOUT, 1);
  const float black[1] = {static_cast<float>(raw.black_level)};
  const std::uint32_t white[1] = {static_cast<std::uint32_t>(std::lround(raw.white_level))};
  TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 1, black);
  TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, white);
  // Camera colours are taken as XYZ, unbalanced: calibration decides later, not the file.
  const float matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const float neutral[3] = {1, 1, 1};
  TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
  TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, 21);  // D65
  TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, neutral);
}

std::string textOf(TIFF* tiff, std::uint32_t tag) {
  const char* text = nullptr;
  return TIFFGetField(tiff, tag, &text) && text ? text : "";
}

void readExif(TIFF* tiff, std::span<const std::byte> file, std::uint64_t offset, RawMosaic& out) {
  if (!TIFFReadEXIFDirectory(tiff, offset)) codecs::refuse("the DNG is damaged: its EXIF");
  if (const auto s = rationalAt(file, offset, EXIFTAG_EXPOSURETIME)) out.exposure = fromSeconds(*s);
  if (const auto f = rationalAt(file, offset, EXIFTAG_FNUMBER)) out.f_number = FNumber{*f};
  std::uint16_t count = 0;
  const std::uint16_t* iso = nullptr;
  if (TIFFGetField(tiff, EXIFTAG_ISOSPEEDRATINGS, &count, &iso) && count > 0)
    out.iso = Iso{static_cast<double>(*iso)};
  std::string date = textOf(tiff, EXIFTAG_DATETIMEORIGINAL);
  if (date.size() != 19) return;
  date[4] = date[7] = '-';
  try {
    out.taken_utc = parseUtc(date + "." + textOf(tiff, EXIFTAG_SUBSECTIMEORIGINAL) + "Z");
  } catch (const ProcessingError&) {
    codecs::refuse("the DNG is damaged: its date");
  }
}

}  // namespace

Bytes encodeDng(const RawMosaic& raw) {
  check(raw);
  MemoryTiff file = MemoryTiff::writing();
  TIFF* tiff = file.handle();
  const std::uint64_t exif = writeExif(tiff, raw);
  TIFFFreeDirectory(tiff);  // the next line would only forget what the EXIF directory holds
  TIFFCreateDirectory(tiff);
  describeSamples(tiff, raw);
  describeCamera(tiff, raw);
  if (exif != 0) TIFFSetField(tiff, TIFFTAG_EXIFIFD, exif);
  const auto& samples = raw.samples.texels();
  const bool good = TIFFWriteEncodedStrip(tiff, 0, const_cast<std::uint16_t*>(samples.data()),
                                          static_cast<tmsize_t>(samples.size() * 2)) >= 0 &&
                    TIFFWriteDirectory(tiff) == 1;
  if (!good) throw ProcessingError(Exit::kCannotCreate, "DNG: " + file.lastError());
  Bytes out = file.finish();
  if (raw.exposure)
    writeRational(out, exif, EXIFTAG_EXPOSURETIME, raw.exposure->count(), 1'000'000'000);
  if (raw.f_number)
    writeRational(out, exif, EXIFTAG_FNUMBER, std::llround(raw.f_number->value * 10'000), 10'000);
  return out;
}

std::optional<RawMosaic> decodeOwnDng(std::span<const std::byte> file,
                                      const PictureLimits& limits) {
  if (sniffFormat(file) != PictureFormat::kDng) return std::nullopt;
  const MemoryTiff in = MemoryTiff::reading(file);
  TIFF* tiff = in.handle();
  if (textOf(tiff, TIFFTAG_SOFTWARE) != kSoftware || in.shortTag(TIFFTAG_PHOTOMETRIC, 0) != kCfa ||
      in.shortTag(TIFFTAG_BITSPERSAMPLE, 0) != 16 || in.shortTag(TIFFTAG_SAMPLESPERPIXEL, 0) != 1 ||
      in.shortTag(TIFFTAG_COMPRESSION, 0) != COMPRESSION_NONE || TIFFIsTiled(tiff) ||
      TIFFNumberOfStrips(tiff) != 1)
    return std::nullopt;
  const auto width = in.longTag(TIFFTAG_IMAGEWIDTH, 0);
  const auto height = in.longTag(TIFFTAG_IMAGELENGTH, 0);
  if (width > 65535 || height > 65535)
    codecs::refuse("the DNG claims more than 65535 pixels a side");
  codecs::checkClaim({.format = PictureFormat::kDng,
                      .size = {static_cast<int>(width), static_cast<int>(height)},
                      .channels = 3,
                      .bits = 16},
                     limits);
  const std::uint64_t bytes = std::uint64_t{width} * height * 2;
  const std::uint64_t offset = TIFFGetStrileOffset(tiff, 0);
  if (TIFFGetStrileByteCount(tiff, 0) != bytes || offset > file.size() ||
      bytes > file.size() - offset)
    codecs::refuse("the DNG is truncated: its samples lie beyond the end; copy it again");

  RawMosaic out;
  std::uint16_t count = 0;
  const std::uint8_t* cfa = nullptr;
  const float* black = nullptr;
  const std::uint32_t* white = nullptr;
  if (!TIFFGetField(tiff, TIFFTAG_CFAPATTERN, &count, &cfa) || count != 4 ||
      !TIFFGetField(tiff, TIFFTAG_BLACKLEVEL, &count, &black) || count != 1 ||
      !TIFFGetField(tiff, TIFFTAG_WHITELEVEL, &count, &white) || count != 1)
    return std::nullopt;
  std::copy_n(cfa, 4, out.cfa.begin());
  out.black_level = *black;
  out.white_level = *white;
  out.make = textOf(tiff, TIFFTAG_MAKE);
  out.model = textOf(tiff, TIFFTAG_MODEL);
  std::uint64_t exif = 0;
  const bool has_exif = TIFFGetField(tiff, TIFFTAG_EXIFIFD, &exif) == 1;
  out.samples = Image<std::uint16_t>(static_cast<int>(width), static_cast<int>(height), 1);
  if (TIFFReadEncodedStrip(tiff, 0, out.samples.texels().data(), static_cast<tmsize_t>(bytes)) !=
      static_cast<tmsize_t>(bytes))
    codecs::refuse("the DNG is damaged (" + in.lastError() + "); copy it again");
  if (has_exif) readExif(tiff, file, exif, out);  // last: it leaves the main directory
  return out;
}

}  // namespace patina
