// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include "db/errors.h"
#include "db/recovery.h"

namespace patina::db {
namespace {

std::int64_t modifiedNs(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return 0;
  return status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec;
}

std::set<std::filesystem::path> foldersOf(const std::filesystem::path& archive,
                                          const std::vector<JournalBatch>& batches) {
  std::set<std::filesystem::path> folders;
  for (const JournalBatch& batch : batches)
    for (const AnyRow& row : batch.rows)
      if (const auto* frame = std::get_if<FrameRecord>(&row)) {
        auto folder = (archive / framePath(frame->row.sha256, frame->row.ext)).parent_path();
        if (std::filesystem::exists(folder)) folders.insert(std::move(folder));
      }
  return folders;
}

std::set<std::filesystem::path> foldersOf(const std::filesystem::path& archive,
                                          OrphanSearch search) {
  std::int64_t newest_line = 0;
  if (search == OrphanSearch::kNewest)
    for (const auto& name : journalNames(archive))
      newest_line = std::max(newest_line, modifiedNs(journalPath(archive, name)));
  std::set<std::filesystem::path> folders;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(archive / "frames", error))
    if (entry.is_directory(error) && modifiedNs(entry.path()) >= newest_line)
      folders.insert(entry.path());
  return folders;
}

std::set<Sha256> hashesOf(const std::vector<JournalTail>& tails) {
  std::set<Sha256> hashes;
  for (const JournalTail& tail : tails)
    for (const JournalBatch& batch : tail.batches)
      for (const AnyRow& row : batch.rows)
        if (const auto* frame = std::get_if<FrameRecord>(&row)) hashes.insert(frame->row.sha256);
  return hashes;
}

}  // namespace

std::optional<StoredName> parseFramePath(const std::filesystem::path& path) {
  const std::string hex = path.parent_path().filename().string() + path.stem().string();
  const std::string ext = path.extension().string();
  if (hex.size() != 64 || ext.size() < 2) return std::nullopt;
  try {
    return StoredName{Sha256::fromHex(hex), ext.substr(1)};
  } catch (const ProcessingError&) {
    return std::nullopt;
  }
}

std::vector<std::string> quarantineOrphans(FileOps& files, const std::filesystem::path& archive,
                                           Database& database,
                                           const std::vector<JournalTail>& tails,
                                           OrphanSearch search,
                                           const std::vector<JournalBatch>& dropped) {
  const std::set<Sha256> journalled = hashesOf(tails);
  Statement known(database, "SELECT 1 FROM frame WHERE sha256 = ? AND ext = ?");
  const auto quarantine = archive / "quarantine";
  // The last start may have died between setting one aside and its sync.
  if (std::filesystem::exists(quarantine))
    checkDisk(files.syncFolder(quarantine), "syncing", quarantine);
  const auto named = foldersOf(archive, dropped);
  auto folders = foldersOf(archive, search);
  folders.insert(named.begin(), named.end());
  std::vector<std::string> moved;
  for (const auto& folder : folders) {
    std::vector<std::filesystem::path> orphans;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const auto name = parseFramePath(entry.path());
      if (name && journalled.contains(name->sha256)) continue;
      if (name) {
        const Reading reading(known);
        known.bind(1, name->sha256.hex()).bind(2, name->ext);
        if (known.step()) continue;
      }
      orphans.push_back(entry.path());
    }
    std::ranges::sort(orphans);
    for (const auto& path : orphans) {
      const auto name = parseFramePath(path);
      const std::string to = name ? name->sha256.hex() + "." + name->ext
                                  : folder.filename().string() + path.filename().string();
      const int made = files.makeFolder(quarantine);
      if (made != -EEXIST) checkDisk(made, "making", quarantine);
      checkDisk(files.renameReplace(path, quarantine / to), "setting aside", path);
      moved.push_back(to);
    }
    if (orphans.empty() && !named.contains(folder)) continue;
    if (!orphans.empty()) checkDisk(files.syncFolder(quarantine), "syncing", quarantine);
    checkDisk(files.syncFolder(folder), "syncing", folder);
  }
  return moved;
}

}  // namespace patina::db
