// SPDX-License-Identifier: GPL-3.0-or-later
// Files from one archive into another, whole and synced or not there. Internal to db/care/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "db/file_ops.h"
#include "db/frame_store.h"

namespace patina::db::care {

// -1: not there.
std::int64_t sizeOf(const std::filesystem::path& path);

// The whole file, hashed as it was read. `error` is an errno, 0 when it could be read.
struct Loaded {
  Bytes bytes;
  Sha256 sha256;
  int error = 0;
};
Loaded load(FileOps& files, const std::filesystem::path& path);

// Writes `bytes` (from 0 on: all; at most `bytes`) of a file under tmp/ of an archive, in pieces,
// synced. Answers where it lies, and the hash of what was written.
struct Copied {
  std::filesystem::path temporary;
  std::int64_t bytes = 0;
  Sha256 sha256;
};
Copied copyToTemporary(FileOps& files, const std::filesystem::path& from,
                       const std::filesystem::path& archive, std::int64_t bytes_max);

}  // namespace patina::db::care
