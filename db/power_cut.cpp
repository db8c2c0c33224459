// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/power_cut.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
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

UndoEntry nameEntry(Kind kind, const std::filesystem::path& path,
                    const std::filesystem::path& to = {}) {
  UndoEntry entry;
  entry.kind = kind;
  entry.path = path, entry.to = to;
  return entry;
}

}  // namespace

struct PowerCutFiles::State {
  // What all handles of one file share.
  struct Opened {
    std::uint64_t file = 0;
    std::filesystem::path path;  // today's; empty once its name is gone
  };

  State(FileOps& disk_, const std::filesystem::path& log_folder) : disk(disk_), log(log_folder) {}

  std::shared_ptr<Opened> opened(const std::filesystem::path& path) {
    std::weak_ptr<Opened>& known = handles[path];
    if (auto there = known.lock()) return there;
    auto fresh = std::make_shared<Opened>();
    fresh->file = log.unsynced().fileAt(path).value_or(0);
    if (fresh->file == 0) fresh->file = log.newFile();
    fresh->path = path;
    known = fresh;
    return fresh;
  }

  void closed(const std::filesystem::path& path) {
    const auto it = handles.find(path);
    if (it != handles.end() && it->second.expired()) handles.erase(it);
  }

  void renamed(const std::filesystem::path& from, const std::filesystem::path& to) {
    gone(to);
    const auto it = handles.find(from);
    if (it == handles.end()) return;
    const auto file = it->second.lock();
    handles.erase(it);
    if (!file) return;
    file->path = to;
    handles[to] = file;
  }

  void gone(const std::filesystem::path& path) {
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
  std::map<std::filesystem::path, std::weak_ptr<Opened>> handles;
  std::vector<std::byte> image;
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
    const std::filesystem::path path = opened_->path;
    opened_.reset();
    state_->closed(path);
  }

  std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
    return disk_->read(into, offset);
  }

  std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
    const std::lock_guard lock(state_->mutex);
    const int got = announce(Kind::kWrite, offset, static_cast<std::int64_t>(data.size()));
    return got < 0 ? got : disk_->write(data, offset);
  }

  int truncate(std::int64_t size) override {
    const std::lock_guard lock(state_->mutex);
    const int got = announce(Kind::kTruncate, size, 0);
    return got < 0 ? got : disk_->truncate(size);
  }

  int sync() override {
    UndoEntry entry;
    {
      const std::lock_guard lock(state_->mutex);
      entry.upto = state_->log.nextSeq() - 1;
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
  // Writes down what a write to [offset, offset + bytes), or a truncation to `offset`, overwrites.
  int announce(Kind kind, std::int64_t offset, std::int64_t bytes) {
    if (opened_->path.empty()) return 0;  // without a name nobody finds it after the cut
    UndoEntry entry = nameEntry(kind, opened_->path);
    entry.file = opened_->file;
    entry.offset = offset, entry.bytes = bytes;
    entry.old_size = disk_->size();
    if (entry.old_size < 0) return static_cast<int>(entry.old_size);
    const std::int64_t end =
        kind == Kind::kWrite ? std::min(offset + bytes, entry.old_size) : entry.old_size;
    std::vector<std::byte>& image = state_->image;
    image.resize(static_cast<std::size_t>(std::max<std::int64_t>(0, end - offset)));
    std::size_t have = 0;
    while (have < image.size()) {
      const std::int64_t got =
          disk_->read(std::span(image).subspan(have), offset + static_cast<std::int64_t>(have));
      if (got < 0) return static_cast<int>(got);
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
    }
    image.resize(have);
    return state_->log.add(entry, image);
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
  *out = std::make_unique<LoggedFile>(state_, state_->opened(path), std::move(*out));
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
