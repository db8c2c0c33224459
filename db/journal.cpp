// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal.h"

#include <algorithm>
#include <cerrno>

#include "db/errors.h"

namespace patina::db {

Journal::Journal(FileOps& files, const std::filesystem::path& archive, const std::string& name)
    : path_(journalPath(archive, name)), name_(name) {
  const int got = files.open(path_, FileOps::Mode::kUpdate, &file_);
  if (got == -ENOENT) {
    checkDisk(files.open(path_, FileOps::Mode::kAppend, &file_), "creating", path_);
    checkDisk(files.syncFolder(path_.parent_path()), "syncing", path_.parent_path());
  } else {
    checkDisk(got, "opening", path_);
  }
  size_ = file_->size();
  checkDisk(size_, "looking at", path_);
  settled_ = size_;
}

void Journal::write(const std::string& lines) {
  if (needs_repair_) repair();
  auto left = std::as_bytes(std::span(lines));
  while (!left.empty()) {
    const std::int64_t got = file_->write(left, size_);
    if (got <= 0) {
      // Part of a line may be there, beyond size_.
      needs_repair_ = true;
      throwDiskError(got < 0 ? static_cast<int>(-got) : ENOSPC, "writing", path_);
    }
    size_ += got;
    left = left.subspan(static_cast<std::size_t>(got));
  }
}

std::int64_t Journal::sizeOnDisk() const {
  const std::int64_t bytes = file_->size();
  checkDisk(bytes, "looking at", path_);
  return bytes;
}

void Journal::sync() {
  // The kernel may call clean what it could not write: a second sync would say yes to nothing.
  const int got = sync_failed_ ? -EIO : file_->sync();
  sync_failed_ |= got < 0 && got != -ENOSPC && got != -EDQUOT;
  checkDisk(got, "syncing", path_);
}

void Journal::takeBack() noexcept {
  if (!pending() && !needs_repair_) return;
  needs_repair_ = file_->truncate(settled_) < 0;
  size_ = settled_;
}

void Journal::repair() {
  checkDisk(file_->truncate(settled_), "cutting", path_);
  size_ = settled_;
  needs_repair_ = false;
}

void Journal::refresh(std::int64_t settled_bytes) {
  size_ = settled_ = settled_bytes;
  if (sizeOnDisk() > settled_bytes) repair();
}

std::filesystem::path journalPath(const std::filesystem::path& archive, const std::string& name) {
  return archive / "journal" / (name + ".jsonl");
}

std::vector<std::string> journalNames(const std::filesystem::path& archive) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(archive / "journal", error))
    if (entry.path().extension() == ".jsonl") names.push_back(entry.path().stem().string());
  std::ranges::sort(
      names, {}, [](const std::string& name) { return std::pair(name != kSharedJournal, name); });
  return names;
}

}  // namespace patina::db
