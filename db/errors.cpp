// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/errors.h"

#include <cerrno>
#include <cstring>

namespace patina::db {

void throwDiskError(int error, const std::string& doing, const std::filesystem::path& path) {
  const std::string what = doing + " " + path.string() + ": " + std::strerror(error);
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      throw DiskFull(what + "; nothing was acknowledged, make room and go on");
    case EROFS:
      throw ArchiveError(Exit::kCannotCreate, what + "; the archive is read-only");
    case EACCES:
    case EPERM:
      throw ArchiveError(Exit::kPermission, what);
    case ENOENT:
    case ENOTDIR:
      throw ArchiveError(Exit::kCannotCreate, what);
    default:
      throw ArchiveError(Exit::kIo, what);
  }
}

void throwGone(const std::filesystem::path& archive) {
  throw ArchiveError(Exit::kIo, "the archive " + archive.string() +
                                    " is gone: was its disk unplugged or unmounted? Bring it back "
                                    "and start again; what was acknowledged is on it");
}

}  // namespace patina::db
