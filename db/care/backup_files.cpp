// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/backup_files.h"

#include <algorithm>
#include <cerrno>

#include "db/errors.h"

namespace patina::db::care {

std::int64_t sizeOf(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? -1 : static_cast<std::int64_t>(size);
}

Loaded load(FileOps& files, const std::filesystem::path& path) {
  Loaded loaded;
  std::unique_ptr<File> file;
  loaded.error = -files.open(path, FileOps::Mode::kRead, &file);
  if (loaded.error > 0) return loaded;
  loaded.error = 0;
  const std::int64_t size = file->size();
  if (size < 0) {
    loaded.error = static_cast<int>(-size);
    return loaded;
  }
  loaded.bytes.resize(static_cast<std::size_t>(size));
  std::size_t have = 0;
  while (have < loaded.bytes.size()) {
    const std::int64_t got =
        file->read(std::span(loaded.bytes).subspan(have), static_cast<std::int64_t>(have));
    if (got <= 0) {
      loaded.error = got < 0 ? static_cast<int>(-got) : EIO;
      return loaded;
    }
    have += static_cast<std::size_t>(got);
  }
  loaded.sha256 = sha256(loaded.bytes);
  return loaded;
}

Copied copyToTemporary(FileOps& files, const std::filesystem::path& from,
                       const std::filesystem::path& archive, std::int64_t bytes_max) {
  constexpr std::size_t kPiece = 1 << 20;
  Copied copied{archive / "tmp" / "copy", 0, {}};
  files.remove(copied.temporary);
  std::unique_ptr<File> in, out;
  checkDisk(realFileOps().open(from, FileOps::Mode::kRead, &in), "opening", from);
  checkDisk(files.open(copied.temporary, FileOps::Mode::kCreate, &out), "creating",
            copied.temporary);
  Sha256Stream hash;
  Bytes piece(kPiece);
  while (copied.bytes < bytes_max) {
    const auto want = std::min<std::int64_t>(kPiece, bytes_max - copied.bytes);
    const std::int64_t got =
        in->read(std::span(piece).first(static_cast<std::size_t>(want)), copied.bytes);
    checkDisk(got, "reading", from);
    if (got == 0) break;
    auto left = std::span<const std::byte>(piece).first(static_cast<std::size_t>(got));
    hash.add(left);
    while (!left.empty()) {
      const std::int64_t put = out->write(left, copied.bytes);
      if (put <= 0)
        throwDiskError(put < 0 ? static_cast<int>(-put) : ENOSPC, "writing", copied.temporary);
      copied.bytes += put;
      left = left.subspan(static_cast<std::size_t>(put));
    }
  }
  checkDisk(out->sync(), "syncing", copied.temporary);
  copied.sha256 = hash.finish();
  return copied;
}

}  // namespace patina::db::care
