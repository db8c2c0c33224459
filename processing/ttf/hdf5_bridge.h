// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 handles that close themselves, without the library's header. Only this room's .cpp files
// include it, and <hdf5.h> beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <mutex>
#include <string>
#include <utility>

#include "processing/image/failure.h"

namespace patina::ttf::hdf5 {

using Id = std::int64_t;            // hid_t; negative: none
using Length = unsigned long long;  // hsize_t

inline constexpr int kChunkFrames = 8, kChunkTexels = 128;  // design: chunks (8,128,128,C)

// Held around every call: the library may be built without its own lock, and prints its errors
// on stderr unless told not to (a setting of the calling thread).
class Session {
 public:
  Session();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

class Handle {
 public:
  using Close = int (*)(Id);
  Handle() = default;
  Handle(Id id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { close(); }
  bool close();  // false: the library could not write what it still held
  Id id() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  Id id_ = -1;
  Close close_ = nullptr;
};

// Throws for the file at hand; `exit` tells a bad file (read) from a failing disk (write).
class Checker {
 public:
  Checker(std::filesystem::path path, Exit exit) : path_(std::move(path)), exit_(exit) {}
  [[noreturn]] void fail(const std::string& what) const;
  void require(bool ok, const std::string& what) const {
    if (!ok) fail(what);
  }
  Handle handle(Id id, Handle::Close close, const std::string& what) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Exit exit_;
};

Handle simpleSpace(std::initializer_list<Length> dims, std::initializer_list<Length> dims_max = {});
Handle halfType();                   // IEEE 754 binary16, little-endian: not a ready-made type
Handle textType(std::size_t bytes);  // of that length, zero-padded
Handle anyTextType();                // UTF-8 of any length

}  // namespace patina::ttf::hdf5
