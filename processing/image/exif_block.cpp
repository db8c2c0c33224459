// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/exif_block.h"

#include <tiff.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>

#include "processing/image/exif_directory.h"
#include "processing/image/failure.h"

namespace patina {
namespace {

constexpr std::size_t kSegmentMax = 65'535;

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

void append(Bytes& to, std::initializer_list<unsigned> bytes) {
  for (const unsigned byte : bytes) to.push_back(static_cast<std::byte>(byte));
}

}  // namespace

TiffRational exifRational(std::int64_t top, std::int64_t bottom) {
  const std::int64_t common = std::gcd(top, bottom);
  top /= common;
  bottom /= common;
  for (; top > UINT32_MAX; top /= 10) bottom = std::max<std::int64_t>(bottom / 10, 1);
  return {static_cast<std::uint32_t>(top), static_cast<std::uint32_t>(bottom)};
}

std::uint32_t appendExif(Bytes& file, const ExifFacts& facts) {
  if (!facts.exposure && !facts.f_number && !facts.iso && !facts.taken_utc && facts.serial.empty())
    return 0;
  TiffDirectoryWriter exif;
  const auto rational = [&](std::uint16_t tag, TiffRational r) {
    exif.rationals(tag, TiffType::kRational, {&r, 1});
  };
  if (facts.exposure)
    rational(EXIFTAG_EXPOSURETIME, exifRational(facts.exposure->count(), 1'000'000'000));
  if (facts.f_number)
    rational(EXIFTAG_FNUMBER, exifRational(std::llround(facts.f_number->value * 10'000), 10'000));
  if (facts.iso)
    exif.shorts(EXIFTAG_ISOSPEEDRATINGS,
                {static_cast<std::uint16_t>(std::lround(facts.iso->value))});
  if (facts.taken_utc) {
    const ExifTime time = exifTime(*facts.taken_utc);
    exif.text(EXIFTAG_DATETIMEORIGINAL, time.date);
    exif.text(EXIFTAG_SUBSECTIMEORIGINAL, time.fraction);
    exif.text(EXIFTAG_OFFSETTIMEORIGINAL, "+00:00");
  }
  if (!facts.serial.empty()) exif.text(kBodySerialNumber, facts.serial);
  return exif.appendTo(file);
}

Bytes jpegWithExif(std::span<const std::byte> jpeg, const ExifFacts& facts) {
  PATINA_CHECK(jpeg.size() > 2);
  Bytes tiff;
  append(tiff, {'I', 'I', 42, 0, 0, 0, 0, 0});
  const std::uint32_t exif = appendExif(tiff, facts);
  TiffDirectoryWriter main;
  if (!facts.make.empty()) main.text(TIFFTAG_MAKE, facts.make);
  if (!facts.model.empty()) main.text(TIFFTAG_MODEL, facts.model);
  if (exif != 0) main.number(TIFFTAG_EXIFIFD, TiffType::kLong, exif);
  const std::uint32_t first = main.appendTo(tiff);
  std::memcpy(tiff.data() + 4, &first, sizeof first);

  const std::size_t segment = 2 + 6 + tiff.size();  // its length, "Exif" and two zeros, the rest
  PATINA_CHECK(segment <= kSegmentMax);
  Bytes out(jpeg.begin(), jpeg.begin() + 2);
  out.reserve(jpeg.size() + 2 + segment);
  append(out, {0xFF, 0xE1, static_cast<unsigned>(segment >> 8),
               static_cast<unsigned>(segment & 255), 'E', 'x', 'i', 'f', 0, 0});
  out.insert(out.end(), tiff.begin(), tiff.end());
  out.insert(out.end(), jpeg.begin() + 2, jpeg.end());
  return out;
}

}  // namespace patina
