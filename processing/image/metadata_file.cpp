// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/metadata_file.h"

#include <algorithm>
#include <cmath>
#include <exiv2/exiv2.hpp>
#include <mutex>

namespace patina {
namespace {

constexpr double kInfinityM = 1e6;  // Exif says 2^32 - 1

// Exiv2 warns on stderr unless told otherwise; absence is all a caller wants to know.
void silenceOnce() {
  static std::once_flag done;
  std::call_once(done, [] { Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute); });
}

std::string textOf(const Exiv2::ExifData& exif, const char* key) {
  const auto it = exif.findKey(Exiv2::ExifKey(key));
  std::string text = it == exif.end() ? "" : it->toString();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

std::optional<double> rationalOf(const Exiv2::ExifData& exif, const char* key) {
  const auto it = exif.findKey(Exiv2::ExifKey(key));
  if (it == exif.end() || it->count() < 1) return std::nullopt;
  const Exiv2::Rational r = it->toRational(0);
  const double top = static_cast<std::uint32_t>(r.first);  // stored unsigned
  const double bottom = static_cast<std::uint32_t>(r.second);
  if (!(top > 0) || !(bottom > 0)) return std::nullopt;
  return top / bottom;
}

// "2024:05:01 12:00:00" with "250" and "+02:00".
void readTime(const Exiv2::ExifData& exif, PictureMetadata& out) {
  std::string text = textOf(exif, "Exif.Photo.DateTimeOriginal");
  std::string fraction = textOf(exif, "Exif.Photo.SubSecTimeOriginal");
  std::string offset = textOf(exif, "Exif.Photo.OffsetTimeOriginal");
  if (text.size() != 19) return;
  text[4] = text[7] = '-';
  if (!fraction.empty() && fraction.find_first_not_of("0123456789") == std::string::npos)
    text += "." + fraction;
  for (const std::string& zone : {offset, std::string("Z")}) {
    if (zone.empty()) continue;
    try {
      out.taken_utc = parseUtc(text + zone);
      out.has_utc_offset = zone == offset;
      return;
    } catch (const ProcessingError&) {
      // A malformed offset is no offset; a malformed date no date.
    }
  }
}

void readExif(const Exiv2::ExifData& exif, PictureMetadata& out) {
  readTime(exif, out);
  if (const auto seconds = rationalOf(exif, "Exif.Photo.ExposureTime"); seconds && *seconds < 1e9)
    out.exposure = fromSeconds(*seconds);
  if (const auto f = rationalOf(exif, "Exif.Photo.FNumber")) out.f_number = FNumber{*f};
  out.focal_mm = rationalOf(exif, "Exif.Photo.FocalLength");
  out.focus_m = rationalOf(exif, "Exif.Photo.SubjectDistance");
  if (out.focus_m) out.focus_m = std::min(*out.focus_m, kInfinityM);
  const auto iso = exif.findKey(Exiv2::ExifKey("Exif.Photo.ISOSpeedRatings"));
  if (iso != exif.end() && iso->count() > 0 && iso->toLong() > 0)
    out.iso = Iso{static_cast<double>(iso->toLong())};
  const std::string make = textOf(exif, "Exif.Image.Make");
  const std::string model = textOf(exif, "Exif.Image.Model");
  // Many models repeat their make.
  const bool repeated = !make.empty() && model.rfind(make, 0) == 0;
  out.camera = make.empty() || repeated ? model : model.empty() ? make : make + " " + model;
}

}  // namespace

PictureMetadata readMetadata(std::span<const std::byte> file) {
  silenceOnce();
  PictureMetadata out;
  if (file.empty()) return out;
  try {
    const auto image = Exiv2::ImageFactory::open(reinterpret_cast<const Exiv2::byte*>(file.data()),
                                                 static_cast<long>(file.size()));
    image->readMetadata();
    readExif(image->exifData(), out);
  } catch (const std::exception&) {
    // Malformed metadata is absence.
  }
  return out;
}

}  // namespace patina
