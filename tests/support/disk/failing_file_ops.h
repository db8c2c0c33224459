// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that fails on demand: at the k-th call, from a call on, or in one of the ways disks fail.
// Run an operation once to count its calls, then once for every k with the k-th failing.
#pragma once

#include <cstdint>
#include <memory>

#include "db/file_ops.h"

namespace patina::testing {

// Thread-safe. Calls of the files it opened and adopted count too; numbers begin at 1.
class FailingFileOps final : public db::FileOps {
 public:
  enum class Call {
    kOpen,
    kRead,
    kWrite,
    kSync,
    kTruncate,
    kSize,
    kRename,
    kSyncFolder,
    kMakeFolder,
    kRemove,
    kSpace,
    kLock
  };
  static constexpr int kCallKinds = 12;

  explicit FailingFileOps(FileOps& disk = db::realFileOps());
  ~FailingFileOps() override;

  // Once, and the call is not made. `error` is an errno: EIO, ENOSPC.
  void failCall(std::int64_t k, int error);
  void failCall(Call kind, std::int64_t k, int error);
  // The k-th write takes half of its bytes and says so.
  void writeShort(std::int64_t k);
  // From the k-th call on the disk is gone: files answer EIO, names ENODEV.
  void unplugFrom(std::int64_t k);
  // Every change answers EROFS, or ENOSPC with no space left; reads work.
  void makeReadOnly();
  void fillUp();
  // The process is ended by SIGKILL just before its k-th call.
  void dieAt(std::int64_t k);
  // The disk is as new; counts go on. resetCounts() starts them again at 0.
  void heal();
  void resetCounts();

  std::int64_t calls() const;
  std::int64_t calls(Call kind) const;
  // Syncs of a file after one of its syncs had failed with EIO. The kernel may call pages clean
  // that it could not write, so that the second sync says yes to nothing: must stay 0.
  std::int64_t syncsAfterFailure() const;

  int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<db::File>* out) override;
  int renameNoReplace(const std::filesystem::path& from, const std::filesystem::path& to) override;
  int renameReplace(const std::filesystem::path& from, const std::filesystem::path& to) override;
  int syncFolder(const std::filesystem::path& folder) override;
  int makeFolder(const std::filesystem::path& folder) override;
  int remove(const std::filesystem::path& path) override;
  int space(const std::filesystem::path& folder, db::Space* out) override;
  int lock(const std::filesystem::path& path, std::unique_ptr<db::FileLock>* out) override;
  int isNetwork(const std::filesystem::path& folder) override;
  std::unique_ptr<db::File> adopt(const std::filesystem::path& path,
                                  std::unique_ptr<db::File> file) override;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace patina::testing
