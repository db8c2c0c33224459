// SPDX-License-Identifier: GPL-3.0-or-later
// The disk as an argument: every byte the archive writes goes through here, SQLite's too (by a thin
// VFS), so that tests can fail the k-th call and take back what was never synced.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace patina::db {

// Calls answer 0 or a positive count, or -errno; EINTR is retried inside.
class File {
 public:
  virtual ~File() = default;  // closes; an error on close after fsync loses nothing
  virtual std::int64_t read(std::span<std::byte> into, std::int64_t offset) = 0;
  virtual std::int64_t write(std::span<const std::byte> data,
                             std::int64_t offset) = 0;  // may be short
  virtual int sync() = 0;  // fdatasync. After -EIO never again on this file: write a new one
  virtual int truncate(std::int64_t size) = 0;
  virtual std::int64_t size() = 0;
  // What the kernel keeps of it in memory may go: the next read asks the disk. A hint.
  virtual void dropCache() {}
};

// Held until destroyed, or until the process dies.
class FileLock {
 public:
  virtual ~FileLock() = default;
};

struct Space {
  std::uint64_t free_bytes = 0, total_bytes = 0;
};

// Thread-safe. Paths are absolute.
class FileOps {
 public:
  virtual ~FileOps() = default;
  enum class Mode { kRead, kCreate /* O_EXCL */, kUpdate /* existing */, kAppend /* or create */ };
  virtual int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<File>* out) = 0;
  // Fails with -EEXIST when `to` is there (renameat2 RENAME_NOREPLACE).
  virtual int renameNoReplace(const std::filesystem::path& from,
                              const std::filesystem::path& to) = 0;
  virtual int renameReplace(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  virtual int syncFolder(const std::filesystem::path& folder) = 0;
  virtual int makeFolder(const std::filesystem::path& folder) = 0;  // -EEXIST is an answer
  virtual int remove(const std::filesystem::path& path) = 0;
  virtual int space(const std::filesystem::path& folder, Space* out) = 0;
  // One owner a file: creates `path` when needed; -EWOULDBLOCK when another process has it.
  virtual int lock(const std::filesystem::path& path, std::unique_ptr<FileLock>* out) = 0;
  // 1 when the folder lies on NFS, SMB and their like, where locks and memory maps cannot be
  // trusted; 0 when it does not.
  virtual int isNetwork(const std::filesystem::path& folder) = 0;
  // Puts a file that SQLite opened under the same regime. The real disk returns it as it is.
  virtual std::unique_ptr<File> adopt(const std::filesystem::path& path,
                                      std::unique_ptr<File> file) = 0;
};

FileOps& realFileOps();

}  // namespace patina::db
