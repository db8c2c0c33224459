// SPDX-License-Identifier: GPL-3.0-or-later
// What a file is and claims, from its first bytes and its structure: nothing is decoded here.
#include <array>
#include <cstring>
#include <string_view>

#include "processing/image/codecs.h"

namespace patina {
namespace {

// Integers of a byte string, bounds checked by the caller's `has`.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, bool big_endian)
      : bytes_(bytes), big_endian_(big_endian) {}
  bool has(std::uint64_t offset, std::uint64_t n) const {
    return offset <= bytes_.size() && n <= bytes_.size() - offset;
  }
  std::uint32_t number(std::size_t offset, int bytes) const {
    std::uint32_t v = 0;
    for (int i = 0; i < bytes; ++i) {
      const auto b = std::to_integer<std::uint32_t>(bytes_[offset + i]);
      v |= b << (8 * (big_endian_ ? bytes - 1 - i : i));
    }
    return v;
  }
  std::uint32_t u16(std::size_t offset) const { return number(offset, 2); }
  std::uint32_t u32(std::size_t offset) const { return number(offset, 4); }

 private:
  std::span<const std::byte> bytes_;
  bool big_endian_;
};

bool startsWith(std::span<const std::byte> file, std::string_view magic, std::size_t offset = 0) {
  return file.size() >= offset + magic.size() &&
         std::memcmp(file.data() + offset, magic.data(), magic.size()) == 0;
}

// Many raw formats are TIFF: the tags of the first directory tell.
PictureFormat sniffTiff(std::span<const std::byte> file) {
  constexpr std::uint32_t kMake = 271, kPhotometric = 262, kSubIfds = 330, kDngVersion = 50706;
  const Reader in(file, startsWith(file, "MM"));
  if (startsWith(file, "CR", 8)) return PictureFormat::kRaw;
  if (!in.has(0, 8)) return PictureFormat::kTiff;
  const std::uint64_t directory = in.u32(4);
  if (!in.has(directory, 2)) return PictureFormat::kTiff;
  bool make = false, sub_ifds = false, cfa = false;
  for (std::uint32_t i = 0, n = in.u16(directory); i < n; ++i) {
    const std::uint64_t entry = directory + 2 + 12ull * i;
    if (!in.has(entry, 12)) break;
    const std::uint32_t tag = in.u16(entry);
    if (tag == kDngVersion) return PictureFormat::kDng;
    make = make || tag == kMake;
    sub_ifds = sub_ifds || tag == kSubIfds;
    cfa = cfa || (tag == kPhotometric && in.u16(entry + 8) == 32803);
  }
  return cfa || (make && sub_ifds) ? PictureFormat::kRaw : PictureFormat::kTiff;
}

bool isFrameHeader(unsigned marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// Offset of the next marker in entropy-coded data (not a stuffed zero, not a restart).
std::size_t skipEntropy(std::span<const std::byte> file, std::size_t at) {
  while (at + 1 < file.size()) {
    const void* found = std::memchr(file.data() + at, 0xFF, file.size() - 1 - at);
    if (!found) break;
    at = static_cast<std::size_t>(static_cast<const std::byte*>(found) - file.data());
    const auto code = std::to_integer<unsigned>(file[at + 1]);
    if (code != 0 && code != 0xFF && !(code >= 0xD0 && code <= 0xD7)) return at;
    at += code == 0xFF ? 1 : 2;
  }
  return file.size();
}

// Of the first directory: every entry of a known type, and values that do not fit into their entry
// inside the file.
bool tiffValuesInside(std::span<const std::byte> file) {
  static constexpr std::array<std::uint8_t, 14> kBytesOfType{0, 1, 1, 2, 4, 8, 1,
                                                             1, 2, 4, 8, 4, 8, 4};
  const Reader in(file, startsWith(file, "MM"));
  if (!in.has(0, 8) || !in.has(in.u32(4), 2)) return false;
  const std::uint64_t directory = in.u32(4);
  const std::uint32_t n = in.u16(directory);
  if (!in.has(directory + 2, 12ull * n + 4)) return false;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint64_t entry = directory + 2 + 12ull * i;
    const std::uint32_t type = in.u16(entry + 2);
    if (type == 0 || type >= kBytesOfType.size()) return false;
    const std::uint64_t bytes = std::uint64_t{in.u32(entry + 4)} * kBytesOfType[type];
    if (bytes > 4 && !in.has(in.u32(entry + 8), bytes)) return false;
  }
  return true;
}

}  // namespace

namespace codecs {

void checkTiffValues(std::span<const std::byte> file) {
  if (!tiffValuesInside(file))
    refuse(
        "the file is truncated or damaged: its directory names values that are not there; copy it "
        "again");
}

void refuse(const std::string& why) { throw ProcessingError(Exit::kBadData, why); }

void checkClaim(const PictureHeader& header, const PictureLimits& limits) {
  const auto [width, height] = header.size;
  const std::string claim = std::to_string(width) + " x " + std::to_string(height);
  if (width <= 0 || height <= 0) refuse("the picture says it is " + claim + " pixels");
  const std::int64_t pixels = static_cast<std::int64_t>(width) * height;
  if (pixels > limits.pixels_max || pixels > limits.decoded_bytes_max / (4 * header.channels)) {
    refuse("the picture claims " + claim + " pixels, more than the limit of " +
           std::to_string(
               std::min(limits.pixels_max, limits.decoded_bytes_max / (4 * header.channels)) /
               1'000'000) +
           " million: make it smaller, or it is not what it seems");
  }
}

PictureHeader readJpegHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  constexpr int kScansMax = 100;  // a progressive camera picture has about ten
  const Reader in(file, true);
  PictureHeader header;
  header.format = PictureFormat::kJpeg;
  int scans = 0;
  std::size_t at = 2;
  for (;;) {
    if (!in.has(at, 2)) refuse("the JPEG is truncated: it has no end marker; copy it again");
    if (in.number(at, 1) != 0xFF) refuse("the JPEG is damaged: a marker is missing");
    const unsigned marker = in.number(at + 1, 1);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xD9) break;
    if (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {
      at += 2;
      continue;
    }
    if (!in.has(at, 4) || !in.has(at + 2, std::max(2u, in.u16(at + 2))))
      refuse("the JPEG is truncated inside a segment; copy it again");
    const std::size_t length = std::max(2u, in.u16(at + 2));
    if (isFrameHeader(marker)) {
      if (length < 8 || header.channels != 0) refuse("the JPEG is damaged: its frame header");
      header.bits = static_cast<int>(in.number(at + 4, 1));
      header.size = {static_cast<int>(in.u16(at + 7)), static_cast<int>(in.u16(at + 5))};
      header.channels = in.number(at + 9, 1) == 1 ? 1 : 3;
      checkClaim(header, limits);
      // Every 8x8 block takes at least one bit.
      if (static_cast<std::int64_t>(header.size.width) * header.size.height / 64 >
          static_cast<std::int64_t>(file.size()) * 8)
        refuse("the JPEG claims more pixels than its bytes can hold");
    }
    at += 2 + length;
    if (marker == 0xDA) {
      if (++scans > kScansMax) refuse("the JPEG has more than 100 scans: refused as hostile");
      at = skipEntropy(file, at);
    }
  }
  if (header.channels == 0 || scans == 0) refuse("the JPEG holds no picture");
  return header;
}

PictureHeader readPngHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  const Reader in(file, true);
  PictureHeader header;
  header.format = PictureFormat::kPng;
  std::uint64_t data_bytes = 0;
  for (std::uint64_t at = 8;;) {
    if (!in.has(at, 12) || !in.has(at + 12, in.u32(at)))
      refuse("the PNG is truncated: it has no end (IEND); copy it again");
    const std::uint64_t length = in.u32(at);
    const bool first = at == 8;
    if (first != startsWith(file, "IHDR", at + 4)) refuse("the PNG is damaged: its first chunk");
    if (first) {
      if (length != 13) refuse("the PNG is damaged: its header");
      const std::uint32_t width = in.u32(at + 8), height = in.u32(at + 12);
      if (width > 0x7fffffff || height > 0x7fffffff) refuse("the PNG is damaged: its size");
      const auto colour = in.number(at + 17, 1);
      header.size = {static_cast<int>(width), static_cast<int>(height)};
      header.bits = in.number(at + 16, 1) == 16 ? 16 : 8;
      header.channels = colour == 0 || colour == 4 ? 1 : 3;
      checkClaim(header, limits);
    }
    if (startsWith(file, "IDAT", at + 4)) data_bytes += length;
    if (startsWith(file, "IEND", at + 4)) break;
    at += 12 + length;
  }
  // Deflate packs at most 1032 to 1; one bit a pixel is the least there is.
  if (static_cast<std::uint64_t>(header.size.width) * header.size.height / 8 / 1032 > data_bytes)
    refuse("the PNG claims more pixels than its bytes can hold");
  return header;
}

}  // namespace codecs

PictureFormat sniffFormat(std::span<const std::byte> file) {
  using namespace std::string_view_literals;
  if (startsWith(file, "\xFF\xD8\xFF"sv)) return PictureFormat::kJpeg;
  if (startsWith(file, "\x89PNG\r\n\x1A\n"sv)) return PictureFormat::kPng;
  if (startsWith(file, "\x76\x2F\x31\x01"sv)) return PictureFormat::kExr;
  if (startsWith(file, "II*\0"sv) || startsWith(file, "MM\0*"sv)) return sniffTiff(file);
  static constexpr std::array kRawMagic{"IIRO"sv, "IIRS"sv, "IIU\0"sv, "FUJIFILMCCD-RAW"sv,
                                        "\0MRM"sv};
  for (std::string_view magic : kRawMagic)
    if (startsWith(file, magic)) return PictureFormat::kRaw;
  if (startsWith(file, "ftypcrx"sv, 4)) return PictureFormat::kRaw;
  return PictureFormat::kUnknown;
}

}  // namespace patina
