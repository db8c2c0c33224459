// SPDX-License-Identifier: GPL-3.0-or-later
// A mount for one test, gone with it.
#pragma once

#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

namespace patina::testing {

class Mounted {
 public:
  static Mounted tmpfs(const std::filesystem::path& place, const std::string& size) {
    return Mounted(place, ::mount("tmpfs", place.c_str(), "tmpfs", 0, ("size=" + size).c_str()));
  }
  static Mounted bind(const std::filesystem::path& folder, const std::filesystem::path& place) {
    return Mounted(place, ::mount(folder.c_str(), place.c_str(), "", MS_BIND, nullptr));
  }
  ~Mounted() {
    if (error_.empty()) detach();
  }
  Mounted(const Mounted&) = delete;
  Mounted& operator=(const Mounted&) = delete;

  const std::string& error() const { return error_; }  // why there is no mount; empty: there is
  bool makeReadOnly() const {
    return ::mount(nullptr, place_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  }
  // As `umount -l`: who has files open keeps them, every path leads elsewhere.
  void detach() const { ::umount2(place_.c_str(), MNT_DETACH); }

 private:
  Mounted(std::filesystem::path place, int answer) : place_(std::move(place)) {
    if (answer != 0) error_ = std::strerror(errno);
  }
  std::filesystem::path place_;
  std::string error_;
};

}  // namespace patina::testing

#define PATINA_MOUNT_OR_SKIP(mounted) \
  if (!(mounted).error().empty()) GTEST_SKIP() << "cannot mount here: " << (mounted).error()
