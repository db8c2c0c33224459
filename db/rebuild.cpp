// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "db/archive_state.h"
#include "db/errors.h"
#include "db/journal_rewrite.h"
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
// read has nothing to say.
void saveWhatJournalsLack(FileOps& files, const std::filesystem::path& archive) {
  const auto file = archive / "catalog.sqlite";
  if (sizeOf(file) == 0) return;
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
    return;
  }
  for (const auto& name : short_ones) rewriteJournal(files, archive, *old, name);
}

void fill(Archive::State& state, const std::filesystem::path& file, Progress& progress) {
  const auto& archive = state.options.folder;
  Database fresh(file, Database::Access::kCreate, *state.files);
  fresh.run("PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF; PRAGMA cache_size=-65536");
  createTables(fresh);
  CatalogueWriter writer(fresh);
  const auto names = journalNames(archive);
  progress.begin("journals", static_cast<std::int64_t>(names.size()));
  Transaction transaction(fresh);
  for (const auto& name : names) {
    const auto path = journalPath(archive, name);
    const Replayed done =
        replayJournal(*state.files, path, sizeOf(path), writer,
                      [&](const JournalBatch& last) { return hasItsFrames(archive, last); });
    if (done.end < sizeOf(path)) cutJournal(*state.files, path, done.end);
    if (done.end > 0) writer.mark(name, done.end);
    state.report.rows_from_journal += static_cast<int>(done.rows);
    progress.step();
  }
  transaction.commit();
  fresh.run("PRAGMA journal_mode=DELETE; PRAGMA synchronous=FULL");
}

// The old WAL must never meet the new database. It goes first, emptied into the old catalogue when
// that can still be opened; a crash in between leaves the old one, or none, and both recover.
void exchange(FileOps& files, const std::filesystem::path& archive,
              const std::filesystem::path& fresh) {
  const auto file = archive / "catalog.sqlite";
  if (sizeOf(file) > 0) {
    try {
      Database old(file, Database::Access::kWrite, files);
      old.run("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const ArchiveError&) {
      checkDisk(files.renameReplace(file, archive / "tmp" / "damaged.sqlite"), "setting aside",
                file);
      checkDisk(files.syncFolder(archive), "syncing", archive);
    }
  }
  for (const char* suffix : {"-wal", "-shm", "-journal"}) {
    const std::filesystem::path beside = file.string() + suffix;
    std::error_code error;
    if (std::filesystem::exists(beside, error)) checkDisk(files.remove(beside), "removing", beside);
  }
  checkDisk(files.syncFolder(archive), "syncing", archive);
  {
    std::unique_ptr<File> whole;
    checkDisk(files.open(fresh, FileOps::Mode::kUpdate, &whole), "opening", fresh);
    checkDisk(whole->sync(), "syncing", fresh);
  }
  checkDisk(files.renameReplace(fresh, file), "renaming to", file);
  checkDisk(files.syncFolder(archive), "syncing", archive);
}

}  // namespace

void rebuildCatalogue(Archive::State& state, Progress& progress) {
  const auto& archive = state.options.folder;
  const auto fresh = archive / "tmp" / "catalog.sqlite";
  for (const char* suffix : {"", "-wal", "-shm", "-journal"})
    state.files->remove(fresh.string() + suffix);
  saveWhatJournalsLack(*state.files, archive);
  fill(state, fresh, progress);
  exchange(*state.files, archive, fresh);
}

RecoveryReport rebuild(const std::filesystem::path& archive, Progress& progress) {
  Archive::State state;
  state.options.folder = std::filesystem::absolute(archive).lexically_normal();
  state.options.owner = "patina archive rebuild";
  state.files = &realFileOps();
  if (!std::filesystem::is_directory(state.options.folder / "journal"))
    throw ArchiveError(Exit::kBadData, archive.string() + " is no archive: it has no journal");
  state.prepare();
  rebuildCatalogue(state, progress);
  const int rows = state.report.rows_from_journal;
  state.openCatalogue();
  const auto orphans = quarantineOrphans(*state.files, state.options.folder, *state.database, {},
                                         OrphanSearch::kEverywhere);
  recover(state);
  for (const auto& name : orphans)
    state.addEvent({0, {}, {}, "quarantine", "frames file without a row: " + name});
  markMissing(state, std::numeric_limits<std::int64_t>::max());
  state.report.rows_from_journal = rows;
  state.report.frames_quarantined += static_cast<int>(orphans.size());
  return state.report;
}

}  // namespace patina::db
