// SPDX-License-Identifier: GPL-3.0-or-later
// Small JPEGs of archived frames: decoded and encoded anew by us, so that no byte of a camera, or
// of a stranger's import, reaches a browser as it is. Where a driver's process has made a small one
// of a frame, that is enough for a view as small, and a raw file need not be decoded again.
#pragma once

#include <list>
#include <mutex>
#include <string>
#include <utility>

#include "db/archive.h"

namespace patina::daemon {

// Thread-safe. One picture is decoded at a time: a raw file costs a hundred megabytes meanwhile.
class Previews {
 public:
  // `width_px` 16 to 1024: the larger side. Keeps the last ones, 8 MB at most. Throws what reading
  // and decoding throw.
  std::string jpeg(const db::ArchiveReader& reader, const db::FrameRow& frame, int width_px);
  // What a driver's process made of `frame`: kThumbnailPx on its longer side, or the frame's own
  // size. Keeps the last ones, 8 MB at most. Never waits for a decoder.
  void take(const Sha256& frame, const Bytes& thumbnail);

 private:
  // By key, the newest first; what is too much is dropped at the end.
  struct Shelf {
    struct Kept {
      std::string key, jpeg;
    };
    std::list<Kept> kept;
    std::size_t bytes = 0;
    const std::string* find(const std::string& key);
    const std::string& put(std::string key, std::string jpeg);
  };
  Bytes sourceOf(const db::ArchiveReader& reader, const db::FrameRow& frame, int width_px);

  std::mutex decoding_;  // guards made_
  Shelf made_;
  std::mutex taking_;  // guards taken_
  Shelf taken_;
};

}  // namespace patina::daemon
