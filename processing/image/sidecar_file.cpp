// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/sidecar_file.h"

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <mutex>

namespace patina {
namespace {

constexpr std::uint64_t kSidecarBytesMax = 16'000'000;

// Exiv2's XMP toolkit keeps state that no two threads may touch.
std::mutex& toolkit() {
  static std::mutex mutex;
  static const bool ready = Exiv2::XmpParser::initialize();
  (void)ready;
  return mutex;
}

std::string textOf(const Exiv2::XmpData& xmp, const char* key) {
  const auto at = xmp.findKey(Exiv2::XmpKey(key));
  return at == xmp.end() ? "" : at->toString();
}

std::optional<double> numberOf(const Exiv2::XmpData& xmp, const char* key) {
  const auto at = xmp.findKey(Exiv2::XmpKey(key));
  if (at == xmp.end() || at->count() < 1) return std::nullopt;
  const Exiv2::Rational r = at->toRational(0);
  if (r.first <= 0 || r.second <= 0) return std::nullopt;
  return static_cast<double>(r.first) / r.second;
}

// Whole nanoseconds where 31 bits hold them, else microseconds.
std::string rationalOf(Nanoseconds d) {
  const bool fits = d.count() < 2'000'000'000;
  return fits ? std::to_string(d.count()) + "/1000000000"
              : std::to_string(d.count() / 1'000'000) + "/1000";
}

}  // namespace

std::filesystem::path sidecarOf(const std::filesystem::path& picture) {
  return picture.string() + ".xmp";
}

std::string encodeSidecar(const PictureMetadata& metadata) {
  const std::lock_guard lock(toolkit());
  Exiv2::XmpData xmp;
  if (metadata.taken_utc) xmp["Xmp.exif.DateTimeOriginal"] = formatUtc(*metadata.taken_utc);
  if (metadata.exposure) xmp["Xmp.exif.ExposureTime"] = rationalOf(*metadata.exposure);
  if (metadata.f_number)
    xmp["Xmp.exif.FNumber"] = std::to_string(std::lround(metadata.f_number->value * 100)) + "/100";
  if (metadata.iso)
    xmp["Xmp.exif.ISOSpeedRatings"] = std::to_string(std::lround(metadata.iso->value));
  if (!metadata.camera.empty()) xmp["Xmp.tiff.Model"] = metadata.camera;
  std::string packet;
  if (Exiv2::XmpParser::encode(packet, xmp, Exiv2::XmpParser::useCompactFormat) != 0)
    throw ProcessingError(Exit::kBug, "Exiv2 cannot write an XMP sidecar");
  return packet;
}

PictureMetadata decodeSidecar(const std::string& text) {
  PictureMetadata out;
  const std::lock_guard lock(toolkit());
  try {
    Exiv2::XmpData xmp;
    if (Exiv2::XmpParser::decode(xmp, text) != 0) return out;
    if (const auto seconds = numberOf(xmp, "Xmp.exif.ExposureTime"); seconds && *seconds < 1e9)
      out.exposure = fromSeconds(*seconds);
    if (const auto f = numberOf(xmp, "Xmp.exif.FNumber")) out.f_number = FNumber{*f};
    if (const auto iso = numberOf(xmp, "Xmp.exif.ISOSpeedRatings")) out.iso = Iso{*iso};
    out.camera = textOf(xmp, "Xmp.tiff.Model");
    if (const std::string time = textOf(xmp, "Xmp.exif.DateTimeOriginal"); !time.empty()) {
      out.taken_utc = parseUtc(time);
      out.has_utc_offset = true;
    }
  } catch (const std::exception&) {
    // A malformed value is absence; those read before it stay.
  }
  return out;
}

PictureMetadata readMetadataOf(const std::filesystem::path& picture,
                               std::span<const std::byte> file) {
  PictureMetadata out = readMetadata(file);
  const std::filesystem::path beside = sidecarOf(picture);
  std::error_code error;
  if (!std::filesystem::is_regular_file(beside, error)) return out;
  const Bytes bytes = readFile(beside, kSidecarBytesMax);
  const PictureMetadata said =
      decodeSidecar({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (said.taken_utc) {
    out.taken_utc = said.taken_utc;
    out.has_utc_offset = true;
  }
  if (said.exposure) out.exposure = said.exposure;
  if (said.iso) out.iso = said.iso;
  if (said.f_number) out.f_number = said.f_number;
  if (!said.camera.empty()) out.camera = said.camera;
  return out;
}

}  // namespace patina
