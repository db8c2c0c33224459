// SPDX-License-Identifier: GPL-3.0-or-later
// Small JPEGs of archived frames: decoded and encoded anew by us, so that no byte of a camera, or
// of a stranger's import, reaches a browser as it is.
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

 private:
  struct Kept {
    std::string key, jpeg;
  };
  std::mutex mutex_;
  std::list<Kept> kept_;  // the newest first
  std::size_t kept_bytes_ = 0;
};

}  // namespace patina::daemon
