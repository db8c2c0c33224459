// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 handles that close themselves. Only this room's .cpp files include it.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

#include "processing/image/failure.h"

namespace patina::ttf::hdf5 {

inline constexpr int kChunkFrames = 8, kChunkTexels = 128;  // design: chunks (8,128,128,C)

// Held around every call: the library may be built without its own lock, and prints its errors
// on stderr unless told not to (a setting of the calling thread).
class Session {
 public:
  Session() : lock_(mutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  static std::recursive_mutex& mutex() {
    static std::recursive_mutex shared;
    return shared;
  }
  std::lock_guard<std::recursive_mutex> lock_;
};

class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { close(); }
  bool close() {  // false: the library could not write what it still held
    if (id_ < 0) return true;
    const Session session;
    return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0;
  }
  hid_t id() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Throws for the file at hand; `exit` tells a bad file (read) from a failing disk (write).
class Checker {
 public:
  Checker(std::filesystem::path path, Exit exit) : path_(std::move(path)), exit_(exit) {}
  [[noreturn]] void fail(const std::string& what) const {
    throw ProcessingError(exit_, path_.string() + ": " + what);
  }
  void require(bool ok, const std::string& what) const {
    if (!ok) fail(what);
  }
  Handle handle(hid_t id, Handle::Close close, const std::string& what) const {
    if (id < 0) fail(what);
    return {id, close};
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Exit exit_;
};

inline Handle simpleSpace(std::initializer_list<hsize_t> dims,
                          std::initializer_list<hsize_t> dims_max = {}) {
  return {H5Screate_simple(static_cast<int>(dims.size()), dims.begin(),
                           dims_max.size() ? dims_max.begin() : nullptr),
          H5Sclose};
}

// IEEE 754 binary16, little-endian: the library has no ready-made type for it.
inline Handle halfType() {
  const hid_t t = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(t, 15, 10, 5, 0, 10);
  H5Tset_size(t, 2);
  H5Tset_ebias(t, 15);
  return {t, H5Tclose};
}

// Text of `bytes` bytes, zero-padded; H5T_VARIABLE for any length.
inline Handle textType(std::size_t bytes) {
  const hid_t t = H5Tcopy(H5T_C_S1);
  H5Tset_size(t, bytes);
  H5Tset_strpad(t, H5T_STR_NULLPAD);
  if (bytes == H5T_VARIABLE) H5Tset_cset(t, H5T_CSET_UTF8);
  return {t, H5Tclose};
}

}  // namespace patina::ttf::hdf5
