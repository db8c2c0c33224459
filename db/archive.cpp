// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "db/archive_state.h"
#include "db/errors.h"

namespace patina::db {
namespace {

using How = Change::How;

std::optional<RunRecord> findRecord(Database& database, const std::string& run_id) {
  Statement statement(database, "SELECT " + columnList<RunRecord>() + " FROM run WHERE id = ?");
  statement.bind(1, run_id);
  if (!statement.step()) return std::nullopt;
  return readRow<RunRecord>(statement);
}

// The row with that name or hash, or a new id for it.
RowId idOr(Database& database, const char* sql, const std::string& key, RowId fresh) {
  Statement statement(database, sql);
  statement.bind(1, key);
  return statement.step() ? statement.integer(0) : fresh;
}

bool holdsFrames(const std::filesystem::path& archive) {
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(archive / "frames", error))
    if (entry.is_regular_file(error)) return true;
  return false;
}

}  // namespace

const char* name(CommitPoint p) {
  switch (p) {
    case CommitPoint::kShotArmed:
      return "shot_armed";
    case CommitPoint::kTmpWritten:
      return "tmp_written";
    case CommitPoint::kTmpSynced:
      return "tmp_synced";
    case CommitPoint::kRenamed:
      return "renamed";
    case CommitPoint::kFolderSynced:
      return "folder_synced";
    case CommitPoint::kJournalSynced:
      return "journal_synced";
    case CommitPoint::kCommitted:
      return "committed";
  }
  PATINA_CHECK(!"a point of the enumeration");
}

Archive::Archive(const ArchiveOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->options.folder = std::filesystem::absolute(options.folder).lexically_normal();
  state_->files = options.files ? options.files : &realFileOps();
  state_->prepare();
  std::error_code error;
  const auto bytes = std::filesystem::file_size(state_->options.folder / "catalog.sqlite", error);
  if (error || bytes == 0) {
    // An empty catalogue would make strangers of all frames.
    if (journalNames(state_->options.folder).empty() && holdsFrames(state_->options.folder))
      throw ArchiveError(Exit::kBadData,
                         options.folder.string() +
                             " has frames but neither catalogue nor journals: 'patina archive "
                             "rebuild' makes a catalogue of what the frames tell");
    Progress silent;
    rebuildCatalogue(*state_, silent);
  }
  state_->openCatalogue();
  recover(*state_);
}

Archive::~Archive() = default;

const RecoveryReport& Archive::recovery() const { return state_->report; }
const ArchiveReader& Archive::reader() const { return *state_->reader; }

void Archive::beginRun(const RunRow& run, const SpecimenRow& specimen) {
  const std::lock_guard lock(state_->mutex);
  state_->beginRun(run, specimen);
}

void Archive::State::beginRun(const RunRow& run, const SpecimenRow& specimen) {
  State& s = *this;
  s.checkUsable();
  checkRunId(run.id);
  RunRecord record{run, 0, 0};
  record.row.number = s.database->number("SELECT max(number) FROM run") + 1;
  commitShared(*s.database, *s.writer, s.journalOf({}), *s.files, s.options.folder,
               [&](Change& change, CatalogueWriter& rows) {
                 SpecimenRow of = specimen;
                 if (of.name.empty()) of.name = run.specimen;
                 of.id = record.specimen_id =
                     idOr(*s.database, "SELECT id FROM specimen WHERE name = ?", of.name,
                          rows.nextId("specimen"));
                 RigRecord rig{0, run.rig, sha256(run.rig_toml).hex(), run.rig_toml};
                 rig.id = record.rig_id = idOr(*s.database, "SELECT id FROM rig WHERE sha256 = ?",
                                               rig.sha256, rows.nextId("rig"));
                 change.add(How::kUpsert, of);
                 change.add(How::kUpsert, rig);
               });
  Change change;
  change.add(How::kInsert, record);
  s.commit(run.id, change);
}

void Archive::setRunState(const std::string& run_id, const std::string& state) {
  const std::lock_guard lock(state_->mutex);
  auto record = findRecord(*state_->database, run_id);
  if (!record) throw ArchiveError(Exit::kUsage, "there is no run '" + run_id + "'");
  record->row.state = state;
  Change change = state_->changeOf(run_id);
  change.add(How::kUpsert, *record);
  state_->commitSmall(run_id, change);
  if (state != "running" && state != "paused") state_->closeJournalOf(run_id);
}

bool Archive::changeRunState(const std::string& run_id, const std::vector<std::string>& from,
                             const std::string& to) {
  const std::lock_guard lock(state_->mutex);
  const auto record = findRecord(*state_->database, run_id);
  if (!record) throw ArchiveError(Exit::kUsage, "there is no run '" + run_id + "'");
  if (std::find(from.begin(), from.end(), record->row.state) == from.end()) return false;
  setRunState(run_id, to);
  return true;
}

std::optional<RunState> Archive::runState(const std::string& run_id) const {
  const std::lock_guard lock(state_->mutex);
  const ArchiveReader& reader = *state_->reader;
  if (!findRecord(*state_->database, run_id)) return std::nullopt;
  RunState found{reader.findRun(run_id), {}, {}};
  Statement& last = reader.state_->statement(Query::kLastNumber);
  const Reading reading_last(last);
  last.bind(1, run_id);
  if (last.step() && !last.isNull(0)) found.last_number = last.integer(0);
  Statement& pending = reader.state_->statement(Query::kUnfinished);
  const Reading reading_pending(pending);
  pending.bind(1, run_id);
  if (pending.step()) found.unfinished = readRow<StepRow>(pending);
  return found;
}

void Archive::addDevice(const DeviceRow& device) {
  const std::lock_guard lock(state_->mutex);
  state_->checkUsable();
  state_->insertDevice(device);
}

RowId Archive::beginStep(const StepRow& step) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  s.checkUsable();
  s.checkNewStep(step);
  StepRow row = step;
  row.id = s.next.step++;
  if (s.deferred.contains(row.run_id)) {  // a step nothing came of; it is kept, as it was begun
    Change change = s.changeOf(row.run_id);
    s.commit(row.run_id, change);
  }
  if (row.decision == Decision::kPending) {
    s.deferred.insert_or_assign(row.run_id, row);
    return row.id;
  }
  Change change;
  change.add(How::kInsert, row);
  s.commitSmall(row.run_id, change);
  return row.id;
}

void Archive::addSteps(std::span<const StepRow> decided) {
  if (decided.empty()) return;
  const std::lock_guard lock(state_->mutex);
  const std::string run_id = decided.front().run_id;
  Change change = state_->changeOf(run_id);
  for (StepRow row : decided) {
    PATINA_CHECK(row.run_id == run_id && row.decision != Decision::kPending);
    state_->checkNewStep(row);
    row.id = state_->next.step++;
    change.add(How::kInsert, row);
  }
  state_->commitSmall(run_id, change);
}

void Archive::finishStep(const StepRow& step) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  Change change;
  // Begun and decided with nothing between: one row, inserted as it ended.
  const auto begun = s.deferred.find(step.run_id);
  const bool in_no_table = begun != s.deferred.end() && begun->second.id == step.id;
  if (!in_no_table) change = s.changeOf(step.run_id);
  change.add(in_no_table ? How::kInsert : How::kFinishStep, step);
  s.commitSmall(step.run_id, change);
}

void Archive::addLightChecks(std::span<const LightCheckRow> checks) {
  if (checks.empty()) return;
  const std::lock_guard lock(state_->mutex);
  const std::string run_id = checks.front().run_id;
  Change change = state_->changeOf(run_id);
  for (LightCheckRow row : checks) {
    PATINA_CHECK(row.run_id == run_id);
    row.id = state_->next.light_check++;
    change.add(How::kInsert, row);
  }
  state_->commit(run_id, change);
}

void Archive::addReading(const ReadingRow& reading) { addReadings({&reading, 1}); }

void Archive::addReadings(std::span<const ReadingRow> readings) {
  if (readings.empty()) return;
  const std::lock_guard lock(state_->mutex);
  const std::string run_id = readings.front().run_id;
  for (const ReadingRow& row : readings) state_->ensureDevice(row.device_id, "sensor");
  Change change = state_->changeOf(run_id);
  for (ReadingRow row : readings) {
    PATINA_CHECK(row.run_id == run_id);
    row.id = state_->next.reading++;
    change.add(How::kInsert, row);
  }
  state_->commit(run_id, change);
}

void Archive::addEvent(const EventRow& event) {
  const std::lock_guard lock(state_->mutex);
  state_->addEvent(event);
}

void Archive::quarantine(std::span<const std::byte> bytes, const std::string& ext,
                         const EventRow& why) {
  const std::lock_guard lock(state_->mutex);
  state_->checkUsable();
  checkExtension(ext);
  state_->store->quarantine(bytes, ext);
  state_->addEvent(why);
}

void Archive::renewReserve() {
  const std::lock_guard lock(state_->mutex);
  state_->keepReserve();
}

Space Archive::space() const {
  Space space;
  const int got = state_->files->space(state_->options.folder, &space);
  if (got == -ENOENT) throwGone(state_->options.folder);
  checkDisk(got, "looking at", state_->options.folder);
  return space;
}

}  // namespace patina::db
