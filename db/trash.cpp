// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/trash.h"

#include <algorithm>
#include <cerrno>

#include "db/errors.h"

namespace patina::db {
namespace {

bool tailNames(const std::vector<JournalTail>& tails, const StoredName& name) {
  for (const JournalTail& tail : tails)
    for (const JournalBatch& batch : tail.batches)
      for (const AnyRow& row : batch.rows)
        if (const auto* frame = std::get_if<FrameRecord>(&row))
          if (frame->row.sha256 == name.sha256 && frame->row.ext == name.ext) return true;
  return false;
}

}  // namespace

bool isNamed(Database& database, const std::vector<JournalTail>& tails, const StoredName& name) {
  Statement known(database, "SELECT 1 FROM frame WHERE sha256 = ? AND ext = ?");
  known.bind(1, name.sha256.hex()).bind(2, name.ext);
  return known.step() || tailNames(tails, name);
}

std::vector<std::filesystem::path> returnNamedFrames(FileOps& files,
                                                     const std::filesystem::path& archive,
                                                     Database& database,
                                                     const std::vector<JournalTail>& tails) {
  std::vector<std::filesystem::path> thrown, back;
  std::error_code error;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(archive / "trash" / "frames", error))
    if (!entry.is_directory(error)) thrown.push_back(entry.path());
  std::ranges::sort(thrown);
  for (const auto& path : thrown) {
    const auto name = parseFramePath(path);
    if (!name || !isNamed(database, tails, *name)) continue;
    const auto place = archive / framePath(name->sha256, name->ext);
    const int made = files.makeFolder(place.parent_path());
    if (made != -EEXIST) checkDisk(made, "making", place.parent_path());
    const int got = files.renameNoReplace(path, place);
    if (got == -EEXIST) continue;  // equal bytes were placed anew
    checkDisk(got, "putting back", place);
    checkDisk(files.syncFolder(place.parent_path()), "syncing", place.parent_path());
    back.push_back(place);
  }
  return back;
}

}  // namespace patina::db
