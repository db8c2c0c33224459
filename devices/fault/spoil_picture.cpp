// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/spoil_picture.h"

#include <algorithm>

#include "processing/image/dng_file.h"
#include "processing/image/encoding.h"
#include "processing/image/random.h"

namespace patina::devices {
namespace {

constexpr std::size_t kBlockBytesMax = 512;  // a USB bulk packet: how cables spoil files

// Starts at even texels, so that a Bayer cell stays whole.
RectPx middleOf(SizePx size) {
  const int width = std::max(2, size.width / 4 * 2), height = std::max(2, size.height / 4 * 2);
  return {(size.width - width) / 4 * 2, (size.height - height) / 4 * 2, width, height};
}

}  // namespace

Bytes cutShort(Bytes file, std::uint64_t seed) {
  const double share = 0.05 + 0.9 * uniform(seed);
  file.resize(static_cast<std::size_t>(share * static_cast<double>(file.size())));
  return file;
}

Bytes changeBlock(Bytes file, std::uint64_t seed) {
  const std::size_t length = std::min(kBlockBytesMax, (file.size() + 1) / 2);
  const std::size_t from = uniformBelow(hashSeed(seed, 0), file.size() - length + 1);
  for (std::size_t i = 0; i < length; ++i) {
    file[from + i] ^= static_cast<std::byte>(1 + uniformBelow(hashSeed(seed, 1, i), 255));
  }
  return file;
}

std::optional<Bytes> shrinkPicture(const Bytes& file) {
  try {
    const PictureFormat format = sniffFormat(file);
    if (format == PictureFormat::kDng) {
      RawMosaic raw = decodeRaw(file);
      if (std::min(raw.samples.width(), raw.samples.height()) < 4) return std::nullopt;
      raw.samples = copyOf<std::uint16_t>(raw.samples.view().crop(middleOf(raw.samples.size())));
      return encodeDng(raw);
    }
    if (format != PictureFormat::kJpeg && format != PictureFormat::kPng) return std::nullopt;
    const Picture picture = decodePicture(file);
    if (std::min(picture.linear.width(), picture.linear.height()) < 4) return std::nullopt;
    const auto small = encodeSrgb8(picture.linear.view().crop(middleOf(picture.linear.size())));
    return format == PictureFormat::kJpeg ? encodeJpeg(small.view()) : encodePng(small.view());
  } catch (const ProcessingError&) {
    return std::nullopt;
  }
}

}  // namespace patina::devices
