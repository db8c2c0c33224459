// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/disk/failing_system_calls.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <string_view>

namespace patina::testing {
namespace {

FailingSystemCalls* active = nullptr;

// The C library's own function of that name.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

int fail(int error) {
  errno = error;
  return -1;
}

int openWith(const char* name, const char* path, int flags, mode_t mode) {
  static auto* const real = next<int(const char*, int, ...)>("open");
  if (active == nullptr) return real(path, flags, mode);
  if (const int error = active->onPath(name, path); error > 0) return fail(error);
  const int fd = real(path, flags, mode);
  if (fd >= 0) active->opened(fd, path);
  return fd;
}

ssize_t writeWith(int fd, const void* data, size_t bytes, off_t offset) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  const int error = active != nullptr ? active->onDescriptor("pwrite", fd) : 0;
  if (error > 0) return fail(error);
  if (error == FailingSystemCalls::kShortWrite) bytes = (bytes + 1) / 2;
  return real(fd, data, bytes, offset);
}

int syncWith(const char* name, int fd) {
  const int error = active != nullptr ? active->onDescriptor(name, fd) : 0;
  if (active != nullptr) active->synced(fd, error);
  return error > 0 ? fail(error) : next<int(int)>(name)(fd);
}

int spaceWith(const char* path, struct statvfs* out) {
  static auto* const real = next<int(const char*, struct statvfs*)>("statvfs");
  const int error = active != nullptr ? active->onPath("statvfs", path) : 0;
  return error > 0 ? fail(error) : real(path, out);
}

}  // namespace

FailingSystemCalls::FailingSystemCalls(const std::filesystem::path& folder)
    : prefix_(folder.string()) {
  active = this;
}

FailingSystemCalls::~FailingSystemCalls() { active = nullptr; }

void FailingSystemCalls::failCall(std::int64_t k, int error) {
  fail_at_ = k;
  error_ = error;
}

bool FailingSystemCalls::covers(const char* path) const {
  return path != nullptr && std::string_view(path).starts_with(prefix_);
}

int FailingSystemCalls::count(const char* call) {
  if (++calls_ != fail_at_) return 0;
  if (error_ == kShortWrite && std::string_view(call) != "pwrite") return 0;
  failed_ = call;
  return error_;
}

int FailingSystemCalls::onPath(const char* call, const char* path) {
  return covers(path) ? count(call) : 0;
}

int FailingSystemCalls::onDescriptor(const char* call, int fd) {
  return open_.contains(fd) ? count(call) : 0;
}

void FailingSystemCalls::opened(int fd, const char* path) {
  if (covers(path)) open_.insert(fd);
}

void FailingSystemCalls::synced(int fd, int error) {
  if (spoilt_.contains(fd)) ++syncs_after_failure_;
  if (error == EIO) spoilt_.insert(fd);
}

void FailingSystemCalls::closed(int fd) {
  open_.erase(fd);
  spoilt_.erase(fd);
}

}  // namespace patina::testing

// In place of the C library's. Programs and shared libraries that were built for 64-bit offsets
// know some of them by other names.
extern "C" {

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return patina::testing::openWith("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return patina::testing::openWith("open", path, flags, mode);
}

ssize_t pwrite(int fd, const void* data, size_t bytes, off_t offset) {
  return patina::testing::writeWith(fd, data, bytes, offset);
}

ssize_t pwrite64(int fd, const void* data, size_t bytes, off64_t offset) {
  return patina::testing::writeWith(fd, data, bytes, offset);
}

int fdatasync(int fd) { return patina::testing::syncWith("fdatasync", fd); }

int fsync(int fd) { return patina::testing::syncWith("fsync", fd); }

int rename(const char* from, const char* to) noexcept {
  using patina::testing::active;
  static auto* const real = patina::testing::next<int(const char*, const char*)>("rename");
  const int error = active != nullptr ? active->onPath("rename", to) : 0;
  return error > 0 ? patina::testing::fail(error) : real(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  using patina::testing::active;
  static auto* const real =
      patina::testing::next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  const int error = active != nullptr ? active->onPath("rename", to) : 0;
  return error > 0 ? patina::testing::fail(error) : real(from_folder, from, to_folder, to, flags);
}

int close(int fd) {
  using patina::testing::active;
  static auto* const real = patina::testing::next<int(int)>("close");
  const int error = active != nullptr ? active->onDescriptor("close", fd) : 0;
  if (active != nullptr) active->closed(fd);
  const int got = real(fd);
  return error > 0 ? patina::testing::fail(error) : got;
}

int statvfs(const char* path, struct statvfs* out) noexcept {
  return patina::testing::spaceWith(path, out);
}

int statvfs64(const char* path, struct statvfs64* out) noexcept {
  return patina::testing::spaceWith(path, reinterpret_cast<struct statvfs*>(out));
}

}  // extern "C"
