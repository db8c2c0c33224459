// SPDX-License-Identifier: GPL-3.0-or-later
// The log of what can be taken back: a folder of plain files outside the archive, written before
// every change, so that it outlives a SIGKILL of the writer (its pages belong to the kernel then).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "db/mapped_log.h"
#include "db/unsynced.h"

namespace patina::db {

// Thread-bound: its user locks. One writer a folder.
class UndoLog {
 public:
  // Opens or creates. What an earlier process left unsynced is unsynced still, unless a cut came
  // between; a change that was announced and never made is struck out. ArchiveError.
  explicit UndoLog(const std::filesystem::path& folder);

  // Numbers `entry` and keeps it with the bytes it is about to overwrite. 0 or -errno: then the
  // change must not be made.
  int add(UndoEntry entry, std::span<const std::byte> image = {});
  std::uint64_t nextSeq() const { return next_seq_; }
  std::uint64_t newFile() { return next_file_++; }

  const Unsynced& unsynced() const { return unsynced_; }
  // Until the next add().
  std::span<const std::byte> image(const UndoEntry& entry) const;

  // Where the file that a removal or a replacement takes away is kept: bury() links or copies it.
  std::filesystem::path grave(std::uint64_t seq) const;
  int bury(const std::filesystem::path& file, std::uint64_t seq);  // 0 or -errno

  void forget();  // everything: the cut is done

 private:
  std::int64_t length() const;
  void load();
  void settle(const UndoEntry& last);
  void compact();
  void dropSpentGraves();

  std::filesystem::path folder_;
  MappedLog log_;
  std::int64_t compact_at_;  // bytes of log
  std::uint64_t next_seq_ = 1, next_file_ = 1;
  Unsynced unsynced_;
};

}  // namespace patina::db
