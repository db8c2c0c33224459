// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/write_behind.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>

namespace patina::ttf {
namespace {

int failureOf(int result) {
  if (result == 0) return 0;
  return errno == EIO || errno == ENOSPC || errno == EDQUOT ? errno : 0;
}

}  // namespace

int WriteBehind::wrote(int fd, std::int64_t bytes) {
  untold_bytes_ += bytes;
  if (untold_bytes_ < piece_bytes_) return 0;
  untold_bytes_ = 0;
  struct stat file {};
  if (::fstat(fd, &file) != 0) return 0;
  const std::int64_t end = file.st_size;
  if (const int error = failureOf(::sync_file_range(fd, sent_, end - sent_, SYNC_FILE_RANGE_WRITE)))
    return error;
  sent_ = end;
  const std::int64_t length = end - window_bytes_ - dropped_;
  if (length < piece_bytes_) return 0;
  const int error = failureOf(::sync_file_range(
      fd, dropped_, length,
      SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER));
  if (error == 0) ::posix_fadvise(fd, dropped_, length, POSIX_FADV_DONTNEED);
  dropped_ += length;
  return error;
}

}  // namespace patina::ttf
