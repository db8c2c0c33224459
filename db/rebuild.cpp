// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <limits>
#include <map>
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

std::string bytesOf(FileOps& files, const std::filesystem::path& path, std::int64_t from) {
  std::unique_ptr<File> file;
  checkDisk(files.open(path, FileOps::Mode::kRead, &file), "opening", path);
  std::string bytes(static_cast<std::size_t>(std::max<std::int64_t>(0, sizeOf(path) - from)), 0);
  for (std::size_t have = 0; have < bytes.size();) {
    const auto left = std::as_writable_bytes(std::span(bytes).subspan(have));
    const std::int64_t got = file->read(left, from + static_cast<std::int64_t>(have));
    checkDisk(got, "reading", path);
    if (got == 0) bytes.resize(have);
    have += static_cast<std::size_t>(got);
  }
  return bytes;
}

bool hasDamagedLines(FileOps& files, const std::filesystem::path& journal, std::int64_t mark) {
  int bad = 0;
  const std::int64_t whole = scanJournal(files, journal, 0, mark,
                                         [&bad](JournalBatch&& batch) { bad += batch.bad_lines; });
  return bad > 0 || whole < mark;
}

// Kept for whoever wants to look: quarantine/<name>-damaged.jsonl.
void keepDamaged(FileOps& files, const std::filesystem::path& archive, const std::string& name) {
  const auto folder = archive / "quarantine", made = archive / "tmp" / (name + "-damaged.jsonl");
  const int got = files.makeFolder(folder);
  if (got != -EEXIST) checkDisk(got, "making", folder);
  files.remove(made);
  {
    std::unique_ptr<File> file;
    checkDisk(files.open(made, FileOps::Mode::kCreate, &file), "creating", made);
    const std::string text = bytesOf(files, journalPath(archive, name), 0);
    auto left = std::as_bytes(std::span(text));
    while (!left.empty()) {
      const std::int64_t put =
          file->write(left, static_cast<std::int64_t>(text.size() - left.size()));
      if (put <= 0) throwDiskError(put < 0 ? static_cast<int>(-put) : ENOSPC, "writing", made);
      left = left.subspan(static_cast<std::size_t>(put));
    }
    checkDisk(file->sync(), "syncing", made);
  }
  const auto kept = folder / made.filename();
  checkDisk(files.renameReplace(made, kept), "renaming to", kept);
  checkDisk(files.syncFolder(folder), "syncing", folder);
}

// What only the old catalogue still knows goes into its journal first; a catalogue that cannot be
// read has nothing to say: false. One that is damaged itself mends no damaged journal.
bool saveWhatJournalsLack(FileOps& files, const std::filesystem::path& archive) {
  const auto file = archive / "catalog.sqlite";
  if (sizeOf(file) == 0) return false;
  std::shared_ptr<Database> old;
  std::vector<std::string> short_ones, damaged;
  std::map<std::string, std::int64_t> mark_of;
  std::int64_t version = 0;
  try {
    old = openForReading(file);
    version = old->number("PRAGMA user_version");
    checkVersion(*old);
    Statement marks(*old, "SELECT journal, bytes FROM journal_mark");
    const bool sound =
        old->number("SELECT count(*) FROM pragma_integrity_check WHERE integrity_check <> 'ok'") ==
        0;
    while (marks.step()) {
      const std::string name(marks.text(0));
      const auto path = journalPath(archive, name);
      mark_of[name] = marks.integer(1);
      if (sizeOf(path) < marks.integer(1))
        short_ones.push_back(name);
      else if (sound && hasDamagedLines(files, path, marks.integer(1)))
        damaged.push_back(name);
    }
  } catch (const ArchiveError&) {
    // Damaged is why we are here; newer is not ours to replace.
    if (version > kSchemaVersion) throw;
    return false;
  }
  for (const auto& name : short_ones) rewriteJournal(files, archive, *old, name);
  for (const auto& name : damaged) {
    keepDamaged(files, archive, name);
    rewriteJournal(files, archive, *old, name,
                   bytesOf(files, journalPath(archive, name), mark_of[name]));
  }
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
