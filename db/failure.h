// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/failure.h"

namespace patina::db {

// The one exception of db/. exit() is kTemporary (locked: the owner is named), kIo (the disk
// failed), kCannotCreate (disk full, read-only), kBadData (newer schema, corrupt), kPermission.
class ArchiveError : public Failure {
 public:
  using Failure::Failure;
};

// No space left. Nothing was acknowledged; the caller may stop cleanly and come back.
class DiskFull : public ArchiveError {
 public:
  explicit DiskFull(const std::string& what) : ArchiveError(Exit::kCannotCreate, what) {}
};

}  // namespace patina::db
