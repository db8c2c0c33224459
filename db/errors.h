// SPDX-License-Identifier: GPL-3.0-or-later
// Turns what the disk or SQLite answered into the one exception of db/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "db/failure.h"

namespace patina::db {

// `error` is a positive errno. DiskFull for ENOSPC and EDQUOT; the exit code follows failure.h.
[[noreturn]] void throwDiskError(int error, const std::string& doing,
                                 const std::filesystem::path& path);
// The archive's own folders are not where they were: kIo.
[[noreturn]] void throwGone(const std::filesystem::path& archive);
// 0 or a count passes, -errno throws.
inline void checkDisk(std::int64_t answer, const std::string& doing,
                      const std::filesystem::path& path) {
  if (answer < 0) throwDiskError(static_cast<int>(-answer), doing, path);
}

}  // namespace patina::db
