// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive_state.h"

#include <algorithm>
#include <cctype>
#include <cerrno>

#include "db/errors.h"
#include "db/lock.h"
#include "db/schema.h"
#include "processing/image/random.h"

namespace patina::db {
namespace {

constexpr std::size_t kReserveBytes = 1 << 20;

void makeFolders(FileOps& files, const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  if (folder.has_parent_path() && folder.parent_path() != folder)
    makeFolders(files, folder.parent_path());
  const int got = files.makeFolder(folder);
  if (got == -EEXIST) return;
  checkDisk(got, "making", folder);
  checkDisk(files.syncFolder(folder.parent_path()), "syncing", folder.parent_path());
}

template <class Row, class Is>
bool contains(const Change::Rows& rows, const Is& is) {
  return std::ranges::any_of(rows, [&](const auto& of) {
    const Row* row = std::get_if<Row>(&of.second);
    return row != nullptr && is(*row);
  });
}

}  // namespace

void checkRunId(const std::string& id) {
  const bool plain =
      !id.empty() && id.size() <= 128 &&
      std::isalnum(static_cast<unsigned char>(id.front())) != 0 &&
      std::ranges::all_of(id, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
      });
  if (!plain)
    throw ArchiveError(Exit::kUsage,
                       "'" + id + "' is no id of a run: letters, digits and - _ . only");
}

void applyRows(CatalogueWriter& writer, const Change::Rows& rows) {
  for (const auto& [how, any] : rows)
    std::visit(
        [&writer, how = how]<class Row>(const Row& row) {
          if constexpr (std::same_as<Row, ShotRow>)
            if (how == Change::How::kSettleShot) return writer.settleShot(row);
          if constexpr (std::same_as<Row, StepRow>)
            if (how == Change::How::kFinishStep) return writer.finishStep(row);
          if (how == Change::How::kInsert) return writer.insert(row);
          writer.replay(row);
        },
        any);
}

void commitShared(Database& database, CatalogueWriter& writer, Journal& shared, FileOps& files,
                  const std::filesystem::path& archive,
                  const std::function<void(Change&, CatalogueWriter&)>& fill) {
  try {
    Transaction transaction(database);
    const std::int64_t mark = writer.markOf(kSharedJournal);
    std::int64_t whole = mark;
    if (shared.sizeOnDisk() > mark)
      whole = scanJournal(files, journalPath(archive, kSharedJournal), mark, shared.sizeOnDisk(),
                          [&](JournalBatch&& batch) {
                            for (const AnyRow& row : batch.rows) writer.replay(row);
                          });
    shared.refresh(whole);
    Change change;
    fill(change, writer);
    applyRows(writer, change.rows);
    shared.write(change.lines.finish());
    shared.sync();
    writer.mark(shared.name(), shared.size());
    transaction.commit();
  } catch (...) {
    shared.takeBack();
    throw;
  }
  shared.settle();
}

void Archive::State::checkUsable() const {
  if (!broken) return;
  throw ArchiveError(Exit::kIo, "the disk of " + options.folder.string() +
                                    " failed while its catalogue or journal was written: start "
                                    "again, which recovers what was acknowledged");
}

Journal& Archive::State::journalOf(const std::string& run_id) {
  if (run_id.empty()) {
    if (!shared_journal)
      shared_journal = std::make_unique<Journal>(*files, options.folder, kSharedJournal);
    return *shared_journal;
  }
  auto& journal = run_journals[run_id];
  if (!journal) journal = std::make_unique<Journal>(*files, options.folder, run_id);
  return *journal;
}

// A daemon sees thousands of runs: those that ended keep no descriptor. A tail that could not be
// cut off keeps its journal, which cuts it before the next line.
void Archive::State::closeJournalOf(const std::string& run_id) {
  const auto found = run_journals.find(run_id);
  if (found != run_journals.end() && !found->second->needsRepair()) run_journals.erase(found);
}

std::string Archive::State::runOfStep(RowId step_id) {
  if (known_step == step_id) return known_run;
  const auto know = [&](const std::string& run_id) {
    known_step = step_id;  // also when its row is in the table
    return known_run = run_id;
  };
  for (const auto& [run_id, step] : deferred)
    if (step.id == step_id) return know(run_id);
  for (const auto& [run_id, rows] : ahead)
    if (contains<StepRow>(rows, [&](const StepRow& step) { return step.id == step_id; }))
      return know(run_id);
  Statement& statement = reader->state_->statement(Query::kRunOfStep);
  const Reading reading(statement);
  statement.bind(1, step_id);
  if (!statement.step())
    throw ArchiveError(Exit::kBadData, "there is no step " + std::to_string(step_id));
  return know(std::string(statement.text(0)));
}

void Archive::State::checkNewStep(const StepRow& step) {
  if (!step.number) return;
  auto at = highest_number.find(step.run_id);
  if (at == highest_number.end()) {
    Statement& last = reader->state_->statement(Query::kLastNumber);
    const Reading reading(last);
    last.bind(1, step.run_id);
    const bool any = last.step() && !last.isNull(0);
    at = highest_number.emplace(step.run_id, any ? last.integer(0) : -1).first;
  }
  if (*step.number <= at->second && reader->step(step.run_id, *step.number))
    throw ArchiveError(Exit::kBadData, "step " + std::to_string(*step.number) + " of run " +
                                           step.run_id + " has its row already");
  at->second = std::max(at->second, *step.number);
}

void Archive::State::checkNewShot(const std::string& run_id, const ShotRow& shot) {
  const auto same = [&](const ShotRow& other) {
    return other.step_id == shot.step_id && other.device_id == shot.device_id &&
           other.light_state == shot.light_state && other.exposure_index == shot.exposure_index &&
           other.attempt == shot.attempt;
  };
  const auto step = [&](const StepRow& row) { return row.id == shot.step_id; };
  const auto begun = deferred.find(run_id);
  const auto waiting = ahead.find(run_id);
  bool armed = false;
  if (waiting != ahead.end()) armed = contains<ShotRow>(waiting->second, same);
  const bool step_is_new = (begun != deferred.end() && step(begun->second)) ||
                           (waiting != ahead.end() && contains<StepRow>(waiting->second, step));
  if (!armed && !step_is_new) {
    Statement& statement = reader->state_->statement(Query::kShotOfKey);
    const Reading reading(statement);
    statement.bind(1, shot.step_id).bind(2, shot.device_id).bind(3, shot.light_state);
    statement.bind(4, std::int64_t{shot.exposure_index}).bind(5, std::int64_t{shot.attempt});
    armed = statement.step();
  }
  if (!armed) return;
  throw ArchiveError(Exit::kBadData, "attempt " + std::to_string(shot.attempt) + " of " +
                                         shot.device_id + ", light " + shot.light_state +
                                         ", exposure " + std::to_string(shot.exposure_index) +
                                         " was armed before");
}

void Archive::State::insertDevice(const DeviceRow& device) {
  commitShared(*database, *writer, journalOf({}), *files, options.folder,
               [&](Change& change, CatalogueWriter&) { change.add(Change::How::kUpsert, device); });
  devices.insert(device.id);
}

void Archive::State::ensureDevice(const std::string& id, const char* kind) {
  if (!devices.contains(id)) insertDevice({id, kind, {}, {}, {}});
}

Change Archive::State::changeOf(const std::string& run_id) const {
  Change change;
  if (const auto begun = deferred.find(run_id); begun != deferred.end())
    change.add(Change::How::kInsert, begun->second);
  return change;
}

void Archive::State::writeLines(Journal& journal, Change& change) {
  try {
    journal.write(change.lines.finish());
  } catch (const ArchiveError&) {
    journal.takeBack();
    throw;
  }
}

void Archive::State::syncJournal(Journal& journal) {
  if (options.mutant != ArchiveOptions::Mutant::kNoFolderSync) journal.sync();
}

void Archive::State::giveUp(Journal& journal, const ArchiveError& error,
                            const std::function<bool()>& undo) {
  // After EIO nobody knows what the disk holds: everything stays, recovery judges it.
  if (error.exit() == Exit::kIo) {
    broken = true;
    return;
  }
  takeBack(journal, undo());
}

void Archive::State::takeBack(Journal& journal, bool frames_gone) noexcept {
  if (frames_gone)
    journal.takeBack();
  else
    broken = true;
}

void Archive::State::writeAhead(const std::string& run_id, Change& change) {
  checkUsable();
  Journal& journal = journalOf(run_id);
  writeLines(journal, change);
  try {
    syncJournal(journal);
  } catch (const ArchiveError& e) {
    giveUp(journal, e, [] { return true; });
    throw;
  }
  journal.settle();
  deferred.erase(run_id);
  auto& rows = ahead[run_id];
  rows.insert(rows.end(), change.rows.begin(), change.rows.end());
}

void Archive::State::commitJournal(Journal& journal, const Change& change,
                                   const std::function<void()>& journal_synced,
                                   const std::function<bool()>& undo) {
  const auto waiting = ahead.find(journal.name());
  try {
    syncJournal(journal);
    journal_synced();
    Transaction transaction(*database);
    if (waiting != ahead.end()) applyRows(*writer, waiting->second);
    applyRows(*writer, change.rows);
    writer->mark(journal.name(), journal.size());
    transaction.commit();
  } catch (const ArchiveError& e) {
    giveUp(journal, e, undo);
    throw;
  }
  journal.settle();
  deferred.erase(journal.name());
  if (waiting != ahead.end()) ahead.erase(waiting);
}

void Archive::State::commit(const std::string& run_id, Change& change) {
  checkUsable();
  if (run_id.empty()) {
    commitShared(*database, *writer, journalOf({}), *files, options.folder,
                 [&](Change& empty, CatalogueWriter&) { std::swap(empty, change); });
    return;
  }
  Journal& journal = journalOf(run_id);
  writeLines(journal, change);
  commitJournal(
      journal, change, [] {}, [] { return true; });
}

void Archive::State::commitSmall(const std::string& run_id, Change& change) {
  Change again = change;
  try {
    commit(run_id, change);
  } catch (const DiskFull&) {
    if (!giveUpReserve()) throw;
    commit(run_id, again);
  }
}

RowId Archive::State::addEvent(const EventRow& event) {
  EventRow row = event;
  row.id = next.event++;
  Change change = changeOf(row.run_id);
  change.add(Change::How::kInsert, row);
  commitSmall(row.run_id, change);
  return row.id;
}

void Archive::State::keepReserve() {
  const auto path = options.folder / "reserve";
  std::unique_ptr<File> file;
  if (files->open(path, FileOps::Mode::kCreate, &file) < 0) return;
  Bytes noise(kReserveBytes);  // zeros would take no room where the file system compresses
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::byte>(hashSeed(i));
  const std::int64_t got = file->write(noise, 0);
  file.reset();
  // Half a reserve on a nearly full disk would only be in the way.
  if (got != static_cast<std::int64_t>(noise.size())) files->remove(path);
}

bool Archive::State::giveUpReserve() { return files->remove(options.folder / "reserve") == 0; }

void Archive::State::prepare() {
  const auto& folder = options.folder;
  makeFolders(*files, folder);
  for (const char* name : {"tmp", "journal", "frames", "products"}) {
    const int got = files->makeFolder(folder / name);
    if (got != -EEXIST) checkDisk(got, "making", folder / name);
  }
  lock = takeLock(*files, folder, options.owner);
  probeFileSystem(*files, folder, options.allow_network_file_system);
}

void Archive::State::openCatalogue() {
  const auto& folder = options.folder;
  database =
      std::make_shared<Database>(folder / "catalog.sqlite", Database::Access::kCreate, *files);
  configureWriter(*database, options.mutant == ArchiveOptions::Mutant::kSynchronousNormal
                                 ? Durability::kNormal
                                 : Durability::kFull);
  migrate(*database);
  checkDisk(files->syncFolder(folder), "syncing", folder);
  writer = std::make_unique<CatalogueWriter>(*database);
  store = std::make_unique<FrameStore>(*files, options);
  auto reading = std::make_unique<ArchiveReader::State>();
  reading->folder = folder;
  reading->database = database;
  reading->owner = &mutex;
  reader.reset(new ArchiveReader(std::move(reading)));
  keepReserve();
}

void Archive::State::loadIds() {
  next = {writer->nextId("step"),    writer->nextId("shot"),        writer->nextId("frame"),
          writer->nextId("reading"), writer->nextId("light_check"), writer->nextId("event")};
  Statement all(*database, "SELECT id FROM device");
  while (all.step()) devices.emplace(all.text(0));
}

}  // namespace patina::db
