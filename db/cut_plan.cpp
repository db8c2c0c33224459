// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/cut_plan.h"

#include <algorithm>
#include <map>
#include <set>

#include "processing/image/random.h"

namespace patina::db {
namespace {

enum Stream : std::uint64_t { kMood = 1, kFile, kFolder, kCount, kTear, kSector, kOrder };

// How many of n changes in a row survive: none, all or some.
std::size_t keptOf(std::size_t n, std::uint64_t seed) {
  const double mood = uniform(hashSeed(seed, kMood));
  if (mood < 0.25) return 0;
  if (mood < 0.45) return n;
  return uniformBelow(hashSeed(seed, kCount), n + 1);
}

std::uint64_t hashText(std::uint64_t seed, const std::string& text) {
  for (const char c : text) seed = hashSeed(seed, static_cast<unsigned char>(c));
  return seed;
}

FileCut cutOf(std::uint64_t file, const Unsynced::OneFile& state, std::uint64_t seed) {
  FileCut cut;
  cut.file = file;
  cut.seed = hashSeed(seed, kFile, file);
  cut.kept = keptOf(state.changes.size(), cut.seed);
  cut.sector = uniform(hashSeed(cut.seed, kSector)) < 0.5 ? 512 : 4096;
  const double tear = uniform(hashSeed(cut.seed, kTear));
  const bool only_writes = std::ranges::all_of(
      state.changes, [](const UndoEntry& e) { return e.kind == UndoEntry::Kind::kWrite; });
  // A size is kept with the journal of the file system: where it shrank, order is kept too.
  if (tear < 0.15 && only_writes)
    cut.tear = FileCut::Tear::kReordered;
  else if (tear < 0.6 && cut.kept < state.changes.size() &&
           state.changes[cut.kept].kind == UndoEntry::Kind::kWrite)
    cut.tear = FileCut::Tear::kTorn;
  return cut;
}

bool touches(const UndoEntry& entry, const std::set<std::string>& lost) {
  return lost.contains(entry.path) || (!entry.to.empty() && lost.contains(entry.to));
}

bool liesUnder(const UndoEntry& entry, const std::vector<std::string>& folders) {
  return std::ranges::any_of(folders, [&](const std::string& folder) {
    const std::string head = folder + "/";
    return entry.path.starts_with(head) || entry.to.starts_with(head);
  });
}

// A prefix per folder; what rests upon a lost change is lost with it, and what follows in its
// folder too.
std::vector<UndoEntry> lostNames(const std::vector<UndoEntry>& names, bool all,
                                 std::uint64_t seed) {
  std::map<std::string, std::size_t> left;
  for (const UndoEntry& e : names) ++left[e.folder()];
  for (auto& [folder, count] : left)
    count = all ? 0 : keptOf(count, hashText(hashSeed(seed, kFolder), folder));

  std::vector<UndoEntry> lost;
  std::set<std::string> lost_paths;
  std::vector<std::string> lost_folders;
  for (const UndoEntry& e : names) {
    std::size_t& here = left[e.folder()];
    if (here > 0 && !touches(e, lost_paths) && !liesUnder(e, lost_folders)) {
      --here;
      continue;
    }
    here = 0;
    lost_paths.insert(e.path);
    if (!e.to.empty()) lost_paths.insert(e.to);
    if (e.kind == UndoEntry::Kind::kMakeFolder) lost_folders.push_back(e.path);
    lost.push_back(e);
  }
  std::ranges::reverse(lost);
  return lost;
}

}  // namespace

bool FileCut::survives(std::size_t index, std::int64_t offset) const {
  const auto at = static_cast<std::uint64_t>(offset);
  if (tear == Tear::kReordered)
    return index < uniformBelow(hashSeed(seed, kOrder, at), 2 * kept + 1);
  if (index < kept) return true;
  return tear == Tear::kTorn && index == kept && uniform(hashSeed(seed, kOrder, at)) < 0.5;
}

CutPlan planCut(const Unsynced& unsynced, std::uint64_t seed) {
  const bool all = uniform(hashSeed(seed, kMood)) < 0.125;
  CutPlan plan;
  for (const auto& [file, state] : unsynced.files()) {
    FileCut cut = cutOf(file, state, seed);
    if (all) cut.kept = 0, cut.tear = FileCut::Tear::kNone;
    if (cut.kept < state.changes.size() || cut.tear != FileCut::Tear::kNone)
      plan.files.push_back(cut);
  }
  plan.names = lostNames(unsynced.names(), all, seed);
  return plan;
}

}  // namespace patina::db
