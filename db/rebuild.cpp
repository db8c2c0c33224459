// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <set>

#include "db/archive_state.h"
#include "db/catalogue_exchange.h"
#include "db/errors.h"
#include "db/journal_rewrite.h"
#include "db/lock.h"
#include "db/mend.h"
#include "db/recovery.h"
#include "db/replica.h"
#include "db/schema.h"

namespace patina::db {
namespace {

std::int64_t sizeOf(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

// What only the old catalogue still knows goes into its journal first; a catalogue that cannot be
// read has nothing to say: false.
bool saveWhatJournalsLack(FileOps& files, const std::filesystem::path& archive) {
  const auto file = archive / "catalog.sqlite";
  if (sizeOf(file) == 0) return false;
  std::shared_ptr<Database> old;
  std::vector<std::string> short_ones;
  std::int64_t version = 0;
  try {
    old = openForReading(file);
    version = old->number("PRAGMA user_version");
    checkVersion(*old);
    Statement marks(*old, "SELECT journal, bytes FROM journal_mark");
    while (marks.step())
      if (sizeOf(journalPath(archive, std::string(marks.text(0)))) < marks.integer(1))
        short_ones.emplace_back(marks.text(0));
  } catch (const ArchiveError&) {
    // Damaged is why we are here; newer is not ours to replace.
    if (version > kSchemaVersion) throw;
    return false;
  }
  for (const auto& name : short_ones) rewriteJournal(files, archive, *old, name);
  return true;
}

void fill(Archive::State& state, const std::filesystem::path& file, Progress& progress) {
  const auto& archive = state.options.folder;
  Database fresh(file, Database::Access::kCreate, *state.files);
  fresh.run("PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF; PRAGMA cache_size=-65536");
  createTables(fresh);
  CatalogueWriter writer(fresh);
  const auto names = journalNames(archive);
  progress.begin("journals", static_cast<std::int64_t>(names.size()));
  std::set<std::string> damaged;
  Transaction transaction(fresh);
  for (const auto& name : names) {
    const auto path = journalPath(archive, name);
    const Replayed done =
        replayJournal(*state.files, path, sizeOf(path), writer,
                      [&](const JournalBatch& last) { return hasItsFrames(archive, last); });
    if (done.end < sizeOf(path)) cutJournal(*state.files, path, done.end);
    if (done.end > 0) writer.mark(name, done.end);
    if (done.bad_lines > 0) damaged.insert(name);
    state.report.rows_from_journal += static_cast<int>(done.rows);
    progress.step();
  }
  if (!damaged.empty()) {
    mendReferences(fresh);
    damaged.insert(kSharedJournal);  // has what was mended
    for (const auto& name : damaged)
      writer.mark(name, rewriteJournal(*state.files, archive, fresh, name));
  }
  transaction.commit();
  fresh.run("PRAGMA journal_mode=DELETE; PRAGMA synchronous=FULL");
}

}  // namespace

bool rebuildCatalogue(Archive::State& state, Progress& progress) {
  const auto& archive = state.options.folder;
  const auto fresh = archive / "tmp" / "catalog.sqlite";
  for (const char* suffix : {"", "-wal", "-shm", "-journal"})
    state.files->remove(fresh.string() + suffix);
  const bool vouched = saveWhatJournalsLack(*state.files, archive);
  fill(state, fresh, progress);
  exchangeCatalogue(*state.files, archive, fresh);
  return vouched;
}

namespace {

// Old catalogue and journals go out of the way, whole.
void setAside(FileOps& files, const std::filesystem::path& archive) {
  std::filesystem::path to;
  for (int n = 1; to.empty() || std::filesystem::exists(to); ++n)
    to = archive / "care" / ("before-rebuild-" + std::to_string(n));
  for (const auto& folder : {to, to / "journal"})
    checkDisk(files.makeFolder(folder), "making", folder);
  const auto move = [&](const std::filesystem::path& name) {
    if (std::filesystem::exists(archive / name))
      checkDisk(files.renameReplace(archive / name, to / name), "setting aside", archive / name);
  };
  for (const auto& name : journalNames(archive))
    move(std::filesystem::path("journal") / (name + ".jsonl"));
  for (const char* suffix : {"-wal", "-shm", ""}) move(std::string("catalog.sqlite") + suffix);
  for (const auto& folder : {to / "journal", to, archive / "journal", archive})
    checkDisk(files.syncFolder(folder), "syncing", folder);
}

enum class From { kJournals, kFrames };

RecoveryReport rebuildFrom(From from, const std::filesystem::path& archive, Progress& progress) {
  Archive::State state;
  state.options.folder = std::filesystem::absolute(archive).lexically_normal();
  state.options.owner = "patina archive rebuild";
  state.files = &realFileOps();
  const auto& folder = state.options.folder;
  if (!std::filesystem::is_directory(folder / "journal") &&
      !std::filesystem::is_directory(folder / "frames"))
    throw ArchiveError(Exit::kBadData,
                       archive.string() + " is no archive: it has neither journal nor frames");
  state.prepare();
  const auto alone = takeCareLock(*state.files, folder, state.options.owner);
  if (from == From::kFrames) setAside(*state.files, folder);
  const bool vouched = rebuildCatalogue(state, progress);
  const int rows = state.report.rows_from_journal;
  state.openCatalogue();
  if (!vouched) {
    state.loadIds();
    adoptFiles(state, progress);
  }
  const auto orphans =
      quarantineOrphans(*state.files, folder, *state.database, {}, OrphanSearch::kEverywhere);
  recover(state);
  for (const auto& name : orphans)
    state.addEvent({0, {}, {}, "quarantine", "frames file without a row: " + name});
  markMissing(state, std::numeric_limits<std::int64_t>::max());
  state.report.rows_from_journal = rows;
  state.report.frames_quarantined += static_cast<int>(orphans.size());
  return state.report;
}

}  // namespace

RecoveryReport rebuild(const std::filesystem::path& archive, Progress& progress) {
  return rebuildFrom(From::kJournals, archive, progress);
}

RecoveryReport rebuildFromFrames(const std::filesystem::path& archive, Progress& progress) {
  return rebuildFrom(From::kFrames, archive, progress);
}

}  // namespace patina::db
