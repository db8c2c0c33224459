// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: libtiff over bytes in memory, errors as text instead of on stderr.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "processing/image/picture_file.h"

struct tiff;  // libtiff's TIFF: its header stays out of this one

namespace patina {

class MemoryTiff {
 public:
  static MemoryTiff reading(std::span<const std::byte> file);  // throws kBadData
  static MemoryTiff writing();
  ~MemoryTiff();
  MemoryTiff(MemoryTiff&&) noexcept;

  tiff* handle() const;
  const std::string& lastError() const;  // of libtiff, empty if none
  Bytes finish();                        // closes a file that was being written

  // One scalar tag of SHORT or LONG; `fallback` when absent.
  std::uint16_t shortTag(std::uint32_t tag, std::uint16_t fallback) const;
  std::uint32_t longTag(std::uint32_t tag, std::uint32_t fallback) const;

 private:
  struct State;
  explicit MemoryTiff(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace patina
