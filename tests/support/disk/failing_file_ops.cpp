// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/disk/failing_file_ops.h"

#include <signal.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace patina::testing {

struct FailingFileOps::State {
  struct Fault {
    std::optional<Call> kind;  // none: any
    std::int64_t at;
    int error;  // 0: a short write
  };

  explicit State(FileOps& disk_) : disk(disk_) {}

  // Counts the call; -errno when it is to fail. `changes` when it would change the disk; `cut`
  // is set when a write is to be short.
  int count(Call kind, bool changes, bool* cut = nullptr) {
    const std::lock_guard lock(mutex);
    const std::int64_t any = ++total, own = ++counts.at(static_cast<std::size_t>(kind));
    if (any == die_at) ::raise(SIGKILL);
    if (unplugged_from > 0 && any >= unplugged_from) return onFile(kind) ? -EIO : -ENODEV;
    const auto it = std::ranges::find_if(faults, [&](const Fault& f) {
      return f.kind ? *f.kind == kind && f.at == own : f.at == any;
    });
    if (it != faults.end()) {
      const int error = it->error;
      faults.erase(it);
      if (error != 0) return -error;
      if (cut != nullptr) *cut = true;
    }
    return changes ? -always : 0;
  }

  void countSyncAfterFailure() {
    const std::lock_guard lock(mutex);
    ++syncs_after_failure;
  }

  static bool onFile(Call kind) {
    return kind == Call::kRead || kind == Call::kWrite || kind == Call::kSync ||
           kind == Call::kTruncate || kind == Call::kSize;
  }

  std::mutex mutex;
  FileOps& disk;
  std::array<std::int64_t, kCallKinds> counts{};
  std::int64_t total = 0, unplugged_from = 0, die_at = 0, syncs_after_failure = 0;
  int always = 0;  // the errno of every change
  std::vector<Fault> faults;
};

namespace {

using Call = FailingFileOps::Call;
using State = FailingFileOps::State;

class FailingFile final : public db::File {
 public:
  FailingFile(std::shared_ptr<State> state, std::unique_ptr<db::File> disk)
      : state_(std::move(state)), disk_(std::move(disk)) {}

  std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
    const int got = state_->count(Call::kRead, false);
    return got < 0 ? got : disk_->read(into, offset);
  }
  std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
    bool cut = false;
    const int got = state_->count(Call::kWrite, true, &cut);
    if (got < 0) return got;
    return disk_->write(cut ? data.first((data.size() + 1) / 2) : data, offset);
  }
  int sync() override {
    if (sync_failed_) state_->countSyncAfterFailure();
    int got = state_->count(Call::kSync, false);
    if (got >= 0) got = disk_->sync();
    sync_failed_ |= got == -EIO;
    return got;
  }
  int truncate(std::int64_t size) override {
    const int got = state_->count(Call::kTruncate, true);
    return got < 0 ? got : disk_->truncate(size);
  }
  std::int64_t size() override {
    const int got = state_->count(Call::kSize, false);
    return got < 0 ? got : disk_->size();
  }

 private:
  std::shared_ptr<State> state_;
  std::unique_ptr<db::File> disk_;
  bool sync_failed_ = false;
};

}  // namespace

FailingFileOps::FailingFileOps(FileOps& disk) : state_(std::make_shared<State>(disk)) {}
FailingFileOps::~FailingFileOps() = default;

void FailingFileOps::failCall(std::int64_t k, int error) {
  const std::lock_guard lock(state_->mutex);
  state_->faults.push_back({std::nullopt, k, error});
}

void FailingFileOps::failCall(Call kind, std::int64_t k, int error) {
  const std::lock_guard lock(state_->mutex);
  state_->faults.push_back({kind, k, error});
}

void FailingFileOps::writeShort(std::int64_t k) { failCall(Call::kWrite, k, 0); }

void FailingFileOps::unplugFrom(std::int64_t k) {
  const std::lock_guard lock(state_->mutex);
  state_->unplugged_from = k;
}

void FailingFileOps::dieAt(std::int64_t k) {
  const std::lock_guard lock(state_->mutex);
  state_->die_at = k;
}

void FailingFileOps::makeReadOnly() {
  const std::lock_guard lock(state_->mutex);
  state_->always = EROFS;
}

void FailingFileOps::fillUp() {
  const std::lock_guard lock(state_->mutex);
  state_->always = ENOSPC;
}

void FailingFileOps::heal() {
  const std::lock_guard lock(state_->mutex);
  state_->faults.clear();
  state_->unplugged_from = state_->die_at = 0;
  state_->always = 0;
}

void FailingFileOps::resetCounts() {
  const std::lock_guard lock(state_->mutex);
  state_->counts.fill(0);
  state_->total = 0;
}

std::int64_t FailingFileOps::calls() const {
  const std::lock_guard lock(state_->mutex);
  return state_->total;
}

std::int64_t FailingFileOps::calls(Call kind) const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts.at(static_cast<std::size_t>(kind));
}

std::int64_t FailingFileOps::syncsAfterFailure() const {
  const std::lock_guard lock(state_->mutex);
  return state_->syncs_after_failure;
}

int FailingFileOps::open(const std::filesystem::path& path, Mode mode,
                         std::unique_ptr<db::File>* out) {
  bool changes = mode != Mode::kRead;
  if (mode != Mode::kCreate && state_->always == ENOSPC)
    changes = mode == Mode::kAppend && !std::filesystem::exists(path);
  if (const int got = state_->count(Call::kOpen, changes); got < 0) return got;
  const int got = state_->disk.open(path, mode, out);
  if (got >= 0) *out = std::make_unique<FailingFile>(state_, std::move(*out));
  return got;
}

int FailingFileOps::renameNoReplace(const std::filesystem::path& from,
                                    const std::filesystem::path& to) {
  const int got = state_->count(Call::kRename, true);
  return got < 0 ? got : state_->disk.renameNoReplace(from, to);
}

int FailingFileOps::renameReplace(const std::filesystem::path& from,
                                  const std::filesystem::path& to) {
  const int got = state_->count(Call::kRename, true);
  return got < 0 ? got : state_->disk.renameReplace(from, to);
}

int FailingFileOps::syncFolder(const std::filesystem::path& folder) {
  const int got = state_->count(Call::kSyncFolder, false);
  return got < 0 ? got : state_->disk.syncFolder(folder);
}

int FailingFileOps::makeFolder(const std::filesystem::path& folder) {
  // A read-only disk, too, says first that a folder is there.
  const bool there = std::filesystem::exists(folder);
  const int got = state_->count(Call::kMakeFolder, !there);
  return got < 0 ? got : state_->disk.makeFolder(folder);
}

int FailingFileOps::remove(const std::filesystem::path& path) {
  // Removing makes room: only a read-only disk refuses it.
  const int got = state_->count(Call::kRemove, state_->always != ENOSPC);
  return got < 0 ? got : state_->disk.remove(path);
}

int FailingFileOps::space(const std::filesystem::path& folder, db::Space* out) {
  if (const int got = state_->count(Call::kSpace, false); got < 0) return got;
  const int got = state_->disk.space(folder, out);
  if (got >= 0 && state_->always == ENOSPC) out->free_bytes = 0;
  return got;
}

int FailingFileOps::lock(const std::filesystem::path& path, std::unique_ptr<db::FileLock>* out) {
  const bool changes = state_->always == EROFS || !std::filesystem::exists(path);
  const int got = state_->count(Call::kLock, changes);
  return got < 0 ? got : state_->disk.lock(path, out);
}

int FailingFileOps::isNetwork(const std::filesystem::path& folder) {
  return state_->disk.isNetwork(folder);
}

std::unique_ptr<db::File> FailingFileOps::adopt(const std::filesystem::path& path,
                                                std::unique_ptr<db::File> file) {
  return std::make_unique<FailingFile>(state_, state_->disk.adopt(path, std::move(file)));
}

}  // namespace patina::testing
