// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/frame_store.h"

#include <algorithm>
#include <cctype>
#include <cerrno>

#include "db/errors.h"

namespace patina::db {
namespace {

using Mutant = ArchiveOptions::Mutant;

}  // namespace

std::filesystem::path framePath(const Sha256& sha256, const std::string& ext) {
  const std::string hex = sha256.hex();
  return std::filesystem::path("frames") / hex.substr(0, 2) / (hex.substr(2) + "." + ext);
}

void checkExtension(const std::string& ext) {
  const bool plain = !ext.empty() && ext.size() <= 16 && std::ranges::all_of(ext, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
  });
  if (!plain)
    throw ArchiveError(Exit::kBadData,
                       "'" + ext + "' is no file extension: 1 to 16 letters or digits");
}

FrameStore::FrameStore(FileOps& files, const ArchiveOptions& options)
    : files_(files), options_(options) {}

int FrameStore::write(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::unique_ptr<File> file;
  const int opened = files_.open(path, FileOps::Mode::kCreate, &file);
  if (opened < 0) return opened;
  std::int64_t offset = 0;
  while (!bytes.empty()) {
    const std::int64_t got = file->write(bytes, offset);
    if (got <= 0) return got < 0 ? static_cast<int>(got) : -ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += got;
  }
  if (options_.at_point) options_.at_point(CommitPoint::kTmpWritten);
  if (options_.mutant != Mutant::kNoFileSync) {
    const int synced = file->sync();
    if (synced < 0) return synced;
  }
  if (options_.at_point) options_.at_point(CommitPoint::kTmpSynced);
  return 0;
}

std::filesystem::path FrameStore::writeTemporary(std::span<const std::byte> bytes,
                                                 const std::string& ext) {
  for (int attempt = 1;; ++attempt) {
    auto path = options_.folder / "tmp" / (std::to_string(++written_) + "." + ext);
    const int got = write(path, bytes);
    if (got == 0) return path;
    if (got == -ENOENT) throwGone(options_.folder);
    forget(path);
    if (got != -EIO || attempt == 2) throwDiskError(-got, "writing", path);
  }
}

bool FrameStore::holds(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::unique_ptr<File> file;
  const int opened = files_.open(path, FileOps::Mode::kRead, &file);
  if (opened == -ENOENT) return false;  // a sweep took it in this moment
  checkDisk(opened, "opening", path);
  if (file->size() != static_cast<std::int64_t>(bytes.size())) return false;
  Bytes there(bytes.size());
  std::size_t have = 0;
  while (have < there.size()) {
    const std::int64_t got =
        file->read(std::span(there).subspan(have), static_cast<std::int64_t>(have));
    if (got <= 0) return false;
    have += static_cast<std::size_t>(got);
  }
  return std::ranges::equal(there, bytes);
}

void FrameStore::makeFolder(const std::filesystem::path& folder) {
  if (known_folders_.contains(folder.string())) return;
  const int got = files_.makeFolder(folder);
  if (got != -EEXIST) checkDisk(got, "making", folder);
  // Also when it was there: a process that died before us may have made it without this sync.
  if (options_.mutant != Mutant::kNoFolderSync)
    checkDisk(files_.syncFolder(folder.parent_path()), "syncing", folder.parent_path());
  known_folders_.insert(folder.string());
}

bool FrameStore::place(const std::filesystem::path& temporary, const Sha256& sha256,
                       const std::string& ext, std::span<const std::byte> bytes) {
  const auto path = options_.folder / framePath(sha256, ext);
  makeFolder(path.parent_path());
  int got = files_.renameNoReplace(temporary, path);
  if (got == -EEXIST && !holds(path, bytes)) {
    const auto aside = options_.folder / "quarantine" / (sha256.hex() + "-damaged." + ext);
    makeFolder(aside.parent_path());
    const int moved = files_.renameReplace(path, aside);
    if (moved != -ENOENT) checkDisk(moved, "setting aside", path);
    got = files_.renameNoReplace(temporary, path);
  }
  if (got == -EEXIST) {
    forget(temporary);
    return false;
  }
  checkDisk(got, "renaming to", path);
  if (options_.at_point) options_.at_point(CommitPoint::kRenamed);
  return true;
}

void FrameStore::syncFolderOf(const Sha256& sha256) {
  const auto folder = options_.folder / "frames" / sha256.hex().substr(0, 2);
  if (options_.mutant != Mutant::kNoFolderSync)
    checkDisk(files_.syncFolder(folder), "syncing", folder);
}

void FrameStore::forget(const std::filesystem::path& path) noexcept { files_.remove(path); }

bool FrameStore::takeAway(std::span<const std::filesystem::path> placed) noexcept {
  bool gone = true;
  for (const auto& path : placed) {
    const int got = files_.remove(path);
    gone &= got >= 0 || got == -ENOENT;
  }
  for (const auto& path : placed) gone = gone && files_.syncFolder(path.parent_path()) >= 0;
  return gone;
}

std::filesystem::path FrameStore::quarantine(std::span<const std::byte> bytes,
                                             const std::string& ext) {
  const auto temporary = writeTemporary(bytes, ext);
  auto path = options_.folder / "quarantine" / (sha256(bytes).hex() + "." + ext);
  makeFolder(path.parent_path());
  const int got = files_.renameNoReplace(temporary, path);
  if (got == -EEXIST)
    forget(temporary);
  else
    checkDisk(got, "renaming to", path);
  checkDisk(files_.syncFolder(path.parent_path()), "syncing", path.parent_path());
  return path;
}

}  // namespace patina::db
