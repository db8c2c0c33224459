// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/preview.h"

#include <algorithm>
#include <span>
#include <utility>

#include "processing/image/picture_file.h"
#include "processing/image/thumbnail.h"

namespace patina::daemon {
namespace {

constexpr std::size_t kKeptBytesMax = 8 << 20;
constexpr PictureLimits kLimits{100'000'000, 1'300'000'000};

std::string textOf(const Bytes& jpeg) {
  return {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()};
}

std::string encode(const Bytes& file, int width_px) {
  return textOf(thumbnailJpeg(decodePicture(file, kLimits), width_px));
}

}  // namespace

const std::string* Previews::Shelf::find(const std::string& key) {
  const auto found = std::ranges::find(kept, key, &Kept::key);
  if (found == kept.end()) return nullptr;
  kept.splice(kept.begin(), kept, found);
  return &kept.front().jpeg;
}

const std::string& Previews::Shelf::put(std::string key, std::string jpeg) {
  bytes += jpeg.size();
  kept.push_front({std::move(key), std::move(jpeg)});
  while (bytes > kKeptBytesMax && kept.size() > 1) {
    bytes -= kept.back().jpeg.size();
    kept.pop_back();
  }
  return kept.front().jpeg;
}

void Previews::take(const Sha256& frame, const Bytes& thumbnail) {
  const std::lock_guard lock(taking_);
  if (taken_.find(frame.hex()) == nullptr) taken_.put(frame.hex(), textOf(thumbnail));
}

Bytes Previews::sourceOf(const db::ArchiveReader& reader, const db::FrameRow& frame, int width_px) {
  if (width_px <= kThumbnailPx) {
    const std::lock_guard lock(taking_);
    if (const std::string* taken = taken_.find(frame.sha256.hex())) {
      const auto bytes = std::as_bytes(std::span(taken->data(), taken->size()));
      return {bytes.begin(), bytes.end()};
    }
  }
  return reader.read(frame);
}

std::string Previews::jpeg(const db::ArchiveReader& reader, const db::FrameRow& frame,
                           int width_px) {
  const int width = std::clamp(width_px, 16, 1024);
  const std::string key = frame.sha256.hex() + " " + std::to_string(width);
  const std::lock_guard lock(decoding_);
  if (const std::string* made = made_.find(key)) return *made;
  return made_.put(key, encode(sourceOf(reader, frame, width), width));
}

}  // namespace patina::daemon
