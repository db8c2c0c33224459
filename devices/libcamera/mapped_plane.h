// SPDX-License-Identifier: GPL-3.0-or-later
// A part of a driver's buffer in memory, for reading.
#pragma once

#include <cstddef>
#include <cstdint>

#include "processing/image/picture_file.h"

namespace patina::devices::libcamera {

class MappedPlane {
 public:
  // Borrows the descriptor. Not good() when it cannot be mapped.
  MappedPlane(int fd, std::size_t offset, std::size_t length);
  MappedPlane(MappedPlane&& other) noexcept;
  MappedPlane& operator=(MappedPlane&&) = delete;
  ~MappedPlane();

  bool good() const { return at_ != nullptr; }
  void appendTo(Bytes& out, std::size_t bytes) const;  // never more than it holds

 private:
  void sync(std::uint64_t when) const;
  int fd_;
  std::size_t offset_, length_;  // mapped from the start of the descriptor: offsets need no page
  const std::byte* at_ = nullptr;
};

}  // namespace patina::devices::libcamera
