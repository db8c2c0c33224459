// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: libtiff over bytes in memory, errors as text instead of on stderr.
#pragma once

#include <tiffio.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "processing/image/picture_file.h"

namespace patina {

class MemoryTiff {
 public:
  static MemoryTiff reading(std::span<const std::byte> file);  // throws kBadData
  static MemoryTiff writing();
  ~MemoryTiff();
  MemoryTiff(MemoryTiff&&) noexcept;

  TIFF* handle() const;
  const std::string& lastError() const;  // of libtiff, empty if none
  Bytes finish();                        // closes a file that was being written

  // One scalar tag; `fallback` when absent.
  template <class T>
  T get(std::uint32_t tag, T fallback) const {
    T value{};
    return TIFFGetFieldDefaulted(handle(), tag, &value) ? value : fallback;
  }

 private:
  struct State;
  explicit MemoryTiff(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace patina
