// SPDX-License-Identifier: GPL-3.0-or-later
// Files named by their SHA-256: frames/<2 hex>/<62 hex>.<ext>, whole and synced or not there.
// Internal to db/.
#pragma once

#include <atomic>
#include <filesystem>
#include <set>
#include <span>
#include <string>

#include "db/archive.h"

namespace patina::db {

// frames/ab/cdef....jpg below the archive.
std::filesystem::path framePath(const Sha256& sha256, const std::string& ext);
// Letters and digits only, up to 16: an extension is part of a path.
void checkExtension(const std::string& ext);

// Thread-bound but for writeTemporary and forget. `files` throws nothing; failures here are
// ArchiveError.
class FrameStore {
 public:
  FrameStore(FileOps& files, const ArchiveOptions& options);

  // A new file under tmp/, synced. EIO: never the same descriptor again; a new file, once.
  std::filesystem::path writeTemporary(std::span<const std::byte> bytes, const std::string& ext);
  // Renames it to its place without replacing. Answers false when equal bytes lay there already;
  // bytes that are damaged there are moved to quarantine/ first.
  bool place(const std::filesystem::path& temporary, const Sha256& sha256, const std::string& ext,
             std::span<const std::byte> bytes);
  void syncFolderOf(const Sha256& sha256);
  // Best effort, after a failure: what was never acknowledged goes away.
  void forget(const std::filesystem::path& path) noexcept;
  // The same for files in their places, for good: their folders are synced. False when the disk
  // would not: some may be there, or come back with the next power cut.
  bool takeAway(std::span<const std::filesystem::path> placed) noexcept;
  // quarantine/<sha256>.<ext>, written and synced.
  std::filesystem::path quarantine(std::span<const std::byte> bytes, const std::string& ext);

 private:
  int write(const std::filesystem::path& path, std::span<const std::byte> bytes);
  bool holds(const std::filesystem::path& path, std::span<const std::byte> bytes);
  void makeFolder(const std::filesystem::path& folder);

  FileOps& files_;
  const ArchiveOptions& options_;
  std::atomic<std::int64_t> written_{0};
  std::set<std::string> known_folders_;  // there, and their parent synced by us
};

}  // namespace patina::db
