// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/power_cut.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "db/undo_log.h"

namespace patina::db {
namespace {

using Kind = UndoEntry::Kind;

std::optional<std::uint64_t> inodeOf(const std::filesystem::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return std::nullopt;
  return status.st_ino;
}

UndoEntry nameEntry(Kind kind, const std::string& path, const std::string& to = {}) {
  UndoEntry entry;
  entry.kind = kind;
  entry.path = path, entry.to = to;
  return entry;
}

// What a file holds from some place on, read ahead: SQLite writes a transaction in many small steps
// one after another, and a system call each would be felt. Forgotten at every sync, since other
// processes may write there between transactions, never within one.
class OldBytes {
 public:
  // Makes [offset, offset + bytes) known. 0 or -errno.
  int read(File& disk, std::int64_t offset, std::int64_t bytes) {
    if (at_ <= offset && (to_end_ || offset + bytes <= end())) return 0;
    forget();
    const auto wanted = static_cast<std::size_t>(std::max(bytes, kAhead));
    if (room_ < wanted) {
      held_ = std::make_unique_for_overwrite<std::byte[]>(wanted);
      room_ = wanted;
    }
    std::size_t have = 0;
    while (have < wanted) {
      const std::int64_t got =
          disk.read({held_.get() + have, wanted - have}, offset + static_cast<std::int64_t>(have));
      if (got < 0) return static_cast<int>(got);
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
    }
    to_end_ = have < wanted;
    size_ = static_cast<std::int64_t>(have);
    at_ = offset;
    if (have > 0) return 0;
    const std::int64_t size = disk.size();
    if (size < 0) return static_cast<int>(size);
    at_ = size;
    return 0;
  }
  // What a write there overwrites, and the end of the file if it moves it, else -1.
  std::span<const std::byte> under(std::int64_t offset, std::int64_t bytes) const {
    const std::int64_t from = std::min(offset, end()), to = std::min(offset + bytes, end());
    return {held_.get() + (from - at_), static_cast<std::size_t>(to - from)};
  }
  std::int64_t endMovedBy(std::int64_t offset, std::int64_t bytes) const {
    return offset + bytes > end() ? end() : -1;
  }
  void overwrite(std::span<const std::byte> data, std::int64_t offset) {
    const std::int64_t data_end = offset + static_cast<std::int64_t>(data.size());
    if (data_end > end()) {  // it was the end of the file
      size_ = 0;
      at_ = data_end;
    } else if (!data.empty()) {
      std::memcpy(held_.get() + (offset - at_), data.data(), data.size());
    }
  }
  void forget() {
    size_ = 0;
    at_ = kNowhere;
    to_end_ = false;
  }
  void startEmpty() {
    forget();
    at_ = 0;
    to_end_ = true;
  }

 private:
  static constexpr std::int64_t kAhead = 32 << 10;
  static constexpr std::int64_t kNowhere = std::numeric_limits<std::int64_t>::max();
  std::int64_t end() const { return at_ + size_; }
  std::int64_t at_ = kNowhere;
  std::int64_t size_ = 0;
  std::unique_ptr<std::byte[]> held_;
  std::size_t room_ = 0;
  bool to_end_ = false;  // held_ goes to the end of the file
};

}  // namespace

struct PowerCutFiles::State {
  // What all handles of one file share.
  struct Opened {
    std::uint64_t file = 0;
    std::string path;  // today's; empty once its name is gone
    OldBytes old;
  };

  State(FileOps& disk_, const std::filesystem::path& log_folder) : disk(disk_), log(log_folder) {}

  std::shared_ptr<Opened> opened(const std::string& path) {
    std::weak_ptr<Opened>& known = handles[path];
    if (auto there = known.lock()) return there;
    auto fresh = std::make_shared<Opened>();
    fresh->file = log.unsynced().fileAt(path).value_or(0);
    if (fresh->file == 0) fresh->file = log.newFile();
    fresh->path = path;
    known = fresh;
    return fresh;
  }

  void closed(const std::string& path) {
    const auto it = handles.find(path);
    if (it != handles.end() && it->second.expired()) handles.erase(it);
  }

  void renamed(const std::string& from, const std::string& to) {
    gone(to);
    const auto it = handles.find(from);
    if (it == handles.end()) return;
    const auto file = it->second.lock();
    handles.erase(it);
    if (!file) return;
    file->path = to;
    handles[to] = file;
  }

  void gone(const std::string& path) {
    const auto it = handles.find(path);
    if (it == handles.end()) return;
    if (const auto file = it->second.lock()) file->path.clear();
    handles.erase(it);
  }

  // Announces a change of names, makes it, and strikes it out when it failed. Locked by the caller.
  template <class Change>
  int change(const UndoEntry& entry, Change make) {
    const std::uint64_t seq = log.nextSeq();
    if (const int got = log.add(entry); got < 0) return got;
    const int done = make();
    if (done >= 0) return done;
    UndoEntry cancelled;
    cancelled.kind = Kind::kCancelled;
    cancelled.upto = seq;
    log.add(cancelled);
    return done;
  }

  // Keeps what `path` holds when the change with the next number takes its name away.
  int bury(const std::filesystem::path& path, UndoEntry* entry) {
    const int got = inodeOf(path) ? log.bury(path, log.nextSeq()) : -ENOENT;
    if (got == 0) entry->saved = 1;
    return got == -ENOENT ? 0 : got;
  }

  std::mutex mutex;
  FileOps& disk;
  UndoLog log;
  std::map<std::string, std::weak_ptr<Opened>> handles;
};

namespace {

using State = PowerCutFiles::State;

class LoggedFile final : public File {
 public:
  LoggedFile(std::shared_ptr<State> state, std::shared_ptr<State::Opened> opened,
             std::unique_ptr<File> disk)
      : state_(std::move(state)), opened_(std::move(opened)), disk_(std::move(disk)) {}
  ~LoggedFile() override {
    const std::lock_guard lock(state_->mutex);
    const std::string path = opened_->path;
    opened_.reset();
    state_->closed(path);
  }

  std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
    return disk_->read(into, offset);
  }

  std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
    const std::lock_guard lock(state_->mutex);
    // Without a name nobody finds it after the cut.
    if (opened_->path.empty()) return disk_->write(data, offset);
    const auto bytes = static_cast<std::int64_t>(data.size());
    OldBytes& old = opened_->old;
    if (const int got = old.read(*disk_, offset, bytes); got < 0) return got;
    UndoEntry entry = entryOf(Kind::kWrite, offset, old.endMovedBy(offset, bytes));
    entry.bytes = bytes;
    if (const int got = state_->log.add(std::move(entry), old.under(offset, bytes)); got < 0)
      return got;
    const std::int64_t got = disk_->write(data, offset);
    if (got == bytes)
      old.overwrite(data, offset);
    else
      old.forget();
    return got;
  }

  int truncate(std::int64_t size) override {
    const std::lock_guard lock(state_->mutex);
    if (opened_->path.empty()) return disk_->truncate(size);
    const std::int64_t old_size = disk_->size();
    if (old_size < 0) return static_cast<int>(old_size);
    OldBytes& old = opened_->old;
    const std::int64_t bytes = std::max<std::int64_t>(0, old_size - size);
    if (const int got = old.read(*disk_, size, bytes); got < 0) return got;
    const UndoEntry entry = entryOf(Kind::kTruncate, size, old_size);
    const int got = state_->log.add(entry, old.under(size, bytes));
    old.forget();
    return got < 0 ? got : disk_->truncate(size);
  }

  int sync() override {
    UndoEntry entry;
    {
      const std::lock_guard lock(state_->mutex);
      entry.upto = state_->log.nextSeq() - 1;
      opened_->old.forget();
    }
    const int got = disk_->sync();
    const std::lock_guard lock(state_->mutex);
    if (!state_->log.unsynced().files().contains(opened_->file)) return got;
    entry.kind = got < 0 ? Kind::kSyncFailed : Kind::kSynced;
    entry.file = opened_->file;
    const int logged = state_->log.add(entry);
    return got < 0 ? got : logged;
  }

  std::int64_t size() override { return disk_->size(); }

 private:
  UndoEntry entryOf(Kind kind, std::int64_t offset, std::int64_t old_size) const {
    UndoEntry entry = nameEntry(kind, opened_->path);
    entry.file = opened_->file;
    entry.offset = offset;
    entry.old_size = old_size;
    return entry;
  }

  std::shared_ptr<State> state_;
  std::shared_ptr<State::Opened> opened_;
  std::unique_ptr<File> disk_;
};

}  // namespace

PowerCutFiles::PowerCutFiles(FileOps& disk, const std::filesystem::path& log_folder)
    : state_(std::make_shared<State>(disk, log_folder)) {}
PowerCutFiles::~PowerCutFiles() = default;

int PowerCutFiles::open(const std::filesystem::path& path, Mode mode, std::unique_ptr<File>* out) {
  if (mode == Mode::kRead) return state_->disk.open(path, mode, out);
  const std::lock_guard lock(state_->mutex);
  const bool creates = mode != Mode::kUpdate && !inodeOf(path);
  const auto make = [&] { return state_->disk.open(path, mode, out); };
  const int got = creates ? state_->change(nameEntry(Kind::kCreate, path), make) : make();
  if (got < 0) return got;
  auto opened = state_->opened(path);
  if (creates)
    opened->old.startEmpty();
  else
    opened->old.forget();
  *out = std::make_unique<LoggedFile>(state_, std::move(opened), std::move(*out));
  return got;
}

int PowerCutFiles::renameNoReplace(const std::filesystem::path& from,
                                   const std::filesystem::path& to) {
  const std::lock_guard lock(state_->mutex);
  const auto inode = inodeOf(from);
  if (!inode || inodeOf(to)) return state_->disk.renameNoReplace(from, to);  // says why not
  UndoEntry entry = nameEntry(Kind::kRename, from, to);
  entry.inode = *inode;
  const int got = state_->change(entry, [&] { return state_->disk.renameNoReplace(from, to); });
  if (got >= 0) state_->renamed(from, to);
  return got;
}

int PowerCutFiles::renameReplace(const std::filesystem::path& from,
                                 const std::filesystem::path& to) {
  const std::lock_guard lock(state_->mutex);
  const auto inode = inodeOf(from);
  if (!inode) return state_->disk.renameReplace(from, to);
  UndoEntry entry = nameEntry(Kind::kRename, from, to);
  entry.inode = *inode;
  if (const int got = state_->bury(to, &entry); got < 0) return got;
  const int got = state_->change(entry, [&] { return state_->disk.renameReplace(from, to); });
  if (got >= 0) state_->renamed(from, to);
  return got;
}

int PowerCutFiles::syncFolder(const std::filesystem::path& folder) {
  UndoEntry entry = nameEntry(Kind::kFolderSynced, folder);
  {
    const std::lock_guard lock(state_->mutex);
    entry.upto = state_->log.nextSeq() - 1;
  }
  const int got = state_->disk.syncFolder(folder);
  if (got < 0) return got;
  const std::lock_guard lock(state_->mutex);
  const auto& names = state_->log.unsynced().names();
  const bool any =
      std::ranges::any_of(names, [&](const UndoEntry& e) { return e.folder() == folder; });
  return any ? state_->log.add(entry) : got;
}

int PowerCutFiles::makeFolder(const std::filesystem::path& folder) {
  const std::lock_guard lock(state_->mutex);
  const auto make = [&] { return state_->disk.makeFolder(folder); };
  return inodeOf(folder) ? make() : state_->change(nameEntry(Kind::kMakeFolder, folder), make);
}

int PowerCutFiles::remove(const std::filesystem::path& path) {
  const std::lock_guard lock(state_->mutex);
  if (!inodeOf(path)) return state_->disk.remove(path);
  UndoEntry entry = nameEntry(Kind::kRemove, path);
  if (const int got = state_->bury(path, &entry); got < 0) return got;
  const int got = state_->change(entry, [&] { return state_->disk.remove(path); });
  if (got >= 0) state_->gone(path);
  return got;
}

int PowerCutFiles::space(const std::filesystem::path& folder, Space* out) {
  return state_->disk.space(folder, out);
}

int PowerCutFiles::lock(const std::filesystem::path& path, std::unique_ptr<FileLock>* out) {
  return state_->disk.lock(path, out);
}

int PowerCutFiles::isNetwork(const std::filesystem::path& folder) {
  return state_->disk.isNetwork(folder);
}

std::unique_ptr<File> PowerCutFiles::adopt(const std::filesystem::path& path,
                                           std::unique_ptr<File> file) {
  auto inner = state_->disk.adopt(path, std::move(file));
  const std::lock_guard lock(state_->mutex);
  return std::make_unique<LoggedFile>(state_, state_->opened(path), std::move(inner));
}

}  // namespace patina::db
