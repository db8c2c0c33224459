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

void apply(CatalogueWriter& writer, const Change& change) {
  for (const auto& [how, any] : change.rows)
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
    apply(writer, change);
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
  for (const auto& [run_id, step] : deferred) {
    if (step.id != step_id) continue;
    known_step = step_id;  // also when its row is in the table
    return known_run = run_id;
  }
  Statement& statement = reader->state_->statement(Query::kRunOfStep);
  const Reading reading(statement);
  statement.bind(1, step_id);
  if (!statement.step())
    throw ArchiveError(Exit::kBadData, "there is no step " + std::to_string(step_id));
  known_step = step_id;
  known_run = statement.text(0);
  return known_run;
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

void Archive::State::commitJournal(Journal& journal, const Change& change,
                                   const std::function<void()>& journal_synced) {
  try {
    if (options.mutant != ArchiveOptions::Mutant::kNoFolderSync) journal.sync();
    if (journal_synced) journal_synced();
    Transaction transaction(*database);
    apply(*writer, change);
    writer->mark(journal.name(), journal.size());
    transaction.commit();
  } catch (const ArchiveError& e) {
    // After EIO nobody knows what the disk holds: the lines stay, recovery judges them.
    if (e.exit() == Exit::kIo)
      broken = true;
    else
      journal.takeBack();
    throw;
  }
  journal.settle();
  deferred.erase(journal.name());
}

void Archive::State::commit(const std::string& run_id, Change& change) {
  checkUsable();
  if (run_id.empty()) {
    commitShared(*database, *writer, journalOf({}), *files, options.folder,
                 [&](Change& empty, CatalogueWriter&) { std::swap(empty, change); });
    return;
  }
  Journal& journal = journalOf(run_id);
  try {
    journal.write(change.lines.finish());
  } catch (const ArchiveError&) {
    journal.takeBack();
    throw;
  }
  commitJournal(journal, change, {});
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
