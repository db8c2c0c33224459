// SPDX-License-Identifier: GPL-3.0-or-later
// What is written to a large file starts on its way to the disk at once, not when the system's
// memory is full of it: the disk works while the next is computed, and the system keeps little.
#pragma once

#include <cstdint>

namespace patina::ttf {

class WriteBehind {
 public:
  static constexpr std::int64_t kPieceBytes = 32 << 20, kWindowBytes = 256 << 20;

  explicit WriteBehind(std::int64_t piece_bytes = kPieceBytes,
                       std::int64_t window_bytes = kWindowBytes)
      : piece_bytes_(piece_bytes), window_bytes_(window_bytes) {}

  // Tells that `bytes` more went to file descriptor `fd`, whose file grows at its end. Every
  // piece what came is sent off; what came more than a window before is waited for, and no longer
  // kept in memory. 0, or the errno of a write that failed on its way (it may not be
  // reported again); file systems that can't be told are left to do as they do.
  [[nodiscard]] int wrote(int fd, std::int64_t bytes);

 private:
  std::int64_t piece_bytes_, window_bytes_, untold_bytes_ = 0, sent_ = 0, dropped_ = 0;
};

}  // namespace patina::ttf
