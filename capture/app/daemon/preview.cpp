// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/preview.h"

#include <algorithm>

#include "processing/image/picture_file.h"
#include "processing/image/thumbnail.h"

namespace patina::daemon {
namespace {

constexpr std::size_t kKeptBytesMax = 8 << 20;
constexpr PictureLimits kLimits{100'000'000, 1'300'000'000};

std::string encode(const Bytes& file, int width_px) {
  const Bytes jpeg = thumbnailJpeg(decodePicture(file, kLimits), width_px);
  return {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()};
}

}  // namespace

std::string Previews::jpeg(const db::ArchiveReader& reader, const db::FrameRow& frame,
                           int width_px) {
  const int width = std::clamp(width_px, 16, 1024);
  const std::string key = frame.sha256.hex() + " " + std::to_string(width);
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.key == key; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    return found->jpeg;
  }
  kept_.push_front({key, encode(reader.read(frame), width)});
  kept_bytes_ += kept_.front().jpeg.size();
  while (kept_bytes_ > kKeptBytesMax && kept_.size() > 1) {
    kept_bytes_ -= kept_.back().jpeg.size();
    kept_.pop_back();
  }
  return kept_.front().jpeg;
}

}  // namespace patina::daemon
