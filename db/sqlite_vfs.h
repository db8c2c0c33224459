// SPDX-License-Identifier: GPL-3.0-or-later
// SQLite's view of a FileOps: a thin layer over its unix VFS. The unix file is kept for locks and
// shared memory; every write, truncate, sync and delete of database, WAL and journal passes the
// seam. A second descriptor of a database must never be closed in the same process (POSIX locks
// would go with it), hence FileOps::adopt and not FileOps::open.
#pragma once

#include <memory>

#include "db/file_ops.h"

namespace patina::db {

// Registered while it lives; must outlive every connection that was opened with its name.
class SqliteVfs {
 public:
  explicit SqliteVfs(FileOps& files);
  ~SqliteVfs();
  SqliteVfs(const SqliteVfs&) = delete;
  SqliteVfs& operator=(const SqliteVfs&) = delete;

  const char* name() const;
  // Writes that follow one another in a WAL are held until its sync and go out as one: SQLite makes
  // two small ones a page. Only for connections with synchronous=FULL, where every commit syncs the
  // WAL before anybody may read it.
  void gatherWrites(bool gather);
  // errno of the last call that failed, 0 when none did since the last question.
  int takeError();

  struct State;  // of the layer; defined in sqlite_vfs.cpp

 private:
  std::unique_ptr<State> state_;
};

}  // namespace patina::db
