// SPDX-License-Identifier: GPL-3.0-or-later
// What a disk was told and was not yet asked to keep: the model behind a simulated power cut. Pure
// bookkeeping, no file is touched here.
//
// The disk modelled is the strictest that POSIX allows and that keeps a rename whole:
//   - the sync of a file keeps its bytes and its size, never its name;
//   - the sync of a folder keeps the names made, renamed into or removed in it, in their order, and
//     whatever earlier change those rest upon (Pillai et al., OSDI 2014).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patina::db {

struct UndoEntry {
  enum class Kind : std::uint32_t {
    kWrite,  // these two change a file's bytes
    kTruncate,
    kCreate,  // these four change names
    kMakeFolder,
    kRename,
    kRemove,
    kSynced,  // these say what the disk keeps from now on, up to the entry `upto`
    kSyncFailed,
    kFolderSynced,
    kCancelled,  // the change `upto` failed and never was
    kHappened    // the last change is known to have been made
  };
  Kind kind = Kind::kHappened;
  std::uint64_t seq = 0;       // grows by one an entry
  std::uint64_t file = 0;      // kWrite, kTruncate, kSynced, kSyncFailed; 0 = none
  std::uint64_t upto = 0;      // the entry it is about; of a write after compaction: removed_by
  std::uint64_t inode = 0;     // kRename: of what was moved
  std::int64_t offset = 0;     // kWrite; kTruncate: the new size
  std::int64_t bytes = 0;      // kWrite
  std::int64_t old_size = -1;  // kWrite, kTruncate; -1: the size stays what it is
  std::uint32_t saved = 0;     // kRename, kRemove: 1 when what the name held lies in the grave
  std::string path, to;        // not std::filesystem::path, which is slow to copy
  // Where the bytes that were overwritten lie in the log.
  std::int64_t image_at = 0, image_bytes = 0;
  bool stuck = false;  // a sync failed after it: no later one can be believed (fsync(2), EIO)

  bool changesBytes() const { return kind <= Kind::kTruncate; }
  bool changesNames() const { return kind >= Kind::kCreate && kind <= Kind::kRemove; }
  // The folder whose sync keeps the name; of a rename the one it goes to.
  std::string folder() const {
    const std::string& name = to.empty() ? path : to;
    return name.substr(0, name.rfind('/'));
  }
};

class Unsynced {
 public:
  struct OneFile {
    std::string path;                // today's; empty when its name is gone for good
    std::vector<UndoEntry> changes;  // in order
    std::uint64_t removed_by = 0;    // the kRemove or kRename that took its name away
  };

  // Entries in order of seq; after a compaction the names come before the bytes.
  void apply(UndoEntry entry);

  bool empty() const { return files_.empty() && names_.empty(); }
  const std::map<std::uint64_t, OneFile>& files() const { return files_; }
  const std::vector<UndoEntry>& names() const { return names_; }
  std::optional<std::uint64_t> fileAt(const std::string& path) const;
  // Graves (by seq) that nothing can ask for any more; each is told once.
  std::vector<std::uint64_t> takeSpentGraves();

 private:
  void rename(const UndoEntry& entry);
  void remove(const UndoEntry& entry);
  void cancel(std::uint64_t seq);
  void syncFile(std::uint64_t file, std::uint64_t upto);
  void syncFolder(const std::string& folder, std::uint64_t upto);
  void keepName(const UndoEntry& entry);

  std::map<std::uint64_t, OneFile> files_;
  std::vector<UndoEntry> names_;
  std::vector<std::uint64_t> spent_graves_;
};

}  // namespace patina::db
