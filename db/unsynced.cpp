// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/unsynced.h"

#include <algorithm>
#include <set>
#include <utility>

namespace patina::db {
namespace {

// `path` with `to` in place of `from`, when it is `from` or lies under it.
std::string moved(const std::string& path, const std::string& from, const std::string& to) {
  if (!path.starts_with(from)) return path;
  if (path.size() > from.size() && path[from.size()] != '/') return path;
  return to + path.substr(from.size());
}

}  // namespace

void Unsynced::apply(UndoEntry entry) {
  using Kind = UndoEntry::Kind;
  switch (entry.kind) {
    case Kind::kWrite:
    case Kind::kTruncate: {
      OneFile& file = files_[entry.file];
      if (file.changes.empty()) file.path = entry.path;
      if (entry.upto != 0) file.removed_by = entry.upto;
      file.changes.push_back(std::move(entry));
      return;
    }
    case Kind::kRename:
      rename(entry);
      break;
    case Kind::kRemove:
      remove(entry);
      break;
    case Kind::kCreate:
    case Kind::kMakeFolder:
      break;
    case Kind::kSynced:
      return syncFile(entry.file, entry.upto);
    case Kind::kSyncFailed:
      if (const auto it = files_.find(entry.file); it != files_.end())
        for (UndoEntry& change : it->second.changes)
          if (change.seq <= entry.upto) change.stuck = true;
      return;
    case Kind::kFolderSynced:
      return syncFolder(entry.path, entry.upto);
    case Kind::kCancelled:
      return cancel(entry.upto);
    case Kind::kHappened:
      return;
  }
  names_.push_back(std::move(entry));
}

std::optional<std::uint64_t> Unsynced::fileAt(const std::string& path) const {
  for (const auto& [file, state] : files_)
    if (state.removed_by == 0 && state.path == path) return file;
  return std::nullopt;
}

std::vector<std::uint64_t> Unsynced::takeSpentGraves() { return std::exchange(spent_graves_, {}); }

void Unsynced::rename(const UndoEntry& entry) {
  if (const auto replaced = fileAt(entry.to)) files_[*replaced].removed_by = entry.seq;
  for (auto& [file, state] : files_)
    if (state.removed_by == 0) state.path = moved(state.path, entry.path, entry.to);
}

void Unsynced::remove(const UndoEntry& entry) {
  if (const auto file = fileAt(entry.path)) files_[*file].removed_by = entry.seq;
}

// Only ever the newest change of names: the caller holds its lock from the entry to the answer.
void Unsynced::cancel(std::uint64_t seq) {
  const auto it = std::ranges::find(names_, seq, &UndoEntry::seq);
  if (it == names_.end()) return;
  if (it->kind == UndoEntry::Kind::kRename)
    for (auto& [file, state] : files_)
      if (state.removed_by == 0) state.path = moved(state.path, it->to, it->path);
  for (auto& [file, state] : files_)
    if (state.removed_by == seq) state.removed_by = 0;
  if (it->saved != 0) spent_graves_.push_back(seq);
  names_.erase(it);
}

// What could not be synced is kept after all once all its bytes were written again and that was
// synced: a page that is written is dirty, whatever became of it before.
void Unsynced::syncFile(std::uint64_t file, std::uint64_t upto) {
  const auto it = files_.find(file);
  if (it == files_.end()) return;
  auto& changes = it->second.changes;
  const auto written_again = [&](const UndoEntry& old) {
    const std::int64_t end = old.offset + old.bytes;
    std::int64_t at = old.offset;
    for (const UndoEntry& e : changes) {
      const bool later = e.kind == UndoEntry::Kind::kWrite && e.seq > old.seq && e.seq <= upto;
      if (later && !e.stuck && e.offset <= at) at = std::max(at, e.offset + e.bytes);
    }
    return old.kind == UndoEntry::Kind::kWrite && at >= end;
  };
  std::set<std::uint64_t> kept;
  for (const UndoEntry& e : changes)
    if (e.seq <= upto && (!e.stuck || written_again(e))) kept.insert(e.seq);
  std::erase_if(changes, [&](const UndoEntry& e) { return kept.contains(e.seq); });
  if (changes.empty()) files_.erase(it);
}

void Unsynced::syncFolder(const std::string& folder, std::uint64_t upto) {
  std::set<std::string> rests_upon;
  std::set<std::uint64_t> kept;
  for (auto it = names_.rbegin(); it != names_.rend(); ++it) {
    const bool here = it->seq <= upto && it->folder() == folder;
    if (!here && !rests_upon.contains(it->path) && !rests_upon.contains(it->to)) continue;
    rests_upon.insert(it->path);
    if (!it->to.empty()) rests_upon.insert(it->to);
    kept.insert(it->seq);
    keepName(*it);
  }
  std::erase_if(names_, [&](const UndoEntry& e) { return kept.contains(e.seq); });
}

void Unsynced::keepName(const UndoEntry& entry) {
  if (entry.saved != 0) spent_graves_.push_back(entry.seq);
  std::erase_if(files_, [&](const auto& item) { return item.second.removed_by == entry.seq; });
}

}  // namespace patina::db
