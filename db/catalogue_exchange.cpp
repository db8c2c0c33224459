// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_exchange.h"

#include "db/database.h"
#include "db/errors.h"

namespace patina::db {

// The old WAL must never meet the new database. It goes first, emptied into the old catalogue when
// that can still be opened; a crash in between leaves the old one, or none, and both recover.
void exchangeCatalogue(FileOps& files, const std::filesystem::path& archive,
                       const std::filesystem::path& fresh) {
  const auto file = archive / "catalog.sqlite";
  std::error_code none;
  const auto bytes = std::filesystem::file_size(file, none);
  if (!none && bytes > 0) {
    try {
      Database old(file, Database::Access::kWrite, files);
      old.run("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const ArchiveError&) {
      checkDisk(files.renameReplace(file, archive / "tmp" / "damaged.sqlite"), "setting aside",
                file);
      checkDisk(files.syncFolder(archive), "syncing", archive);
    }
  }
  for (const char* suffix : {"-wal", "-shm", "-journal"}) {
    const std::filesystem::path beside = file.string() + suffix;
    std::error_code error;
    if (std::filesystem::exists(beside, error)) checkDisk(files.remove(beside), "removing", beside);
  }
  checkDisk(files.syncFolder(archive), "syncing", archive);
  {
    std::unique_ptr<File> whole;
    checkDisk(files.open(fresh, FileOps::Mode::kUpdate, &whole), "opening", fresh);
    checkDisk(whole->sync(), "syncing", fresh);
  }
  checkDisk(files.renameReplace(fresh, file), "renaming to", file);
  checkDisk(files.syncFolder(archive), "syncing", archive);
}

}  // namespace patina::db
