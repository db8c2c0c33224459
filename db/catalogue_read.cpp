// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_read.h"

#include <utility>

#include "db/errors.h"
#include "db/frame_store.h"
#include "db/row_statements.h"
#include "db/schema.h"

namespace patina::db {
namespace {

std::string selectFrom(const std::string& list, const char* rest) {
  return "SELECT " + list + " FROM " + rest;
}
std::string runList() { return columnList<RunRecord>("run.") + ", specimen.name, rig.name"; }
constexpr const char* kRunTables =
    "run JOIN specimen ON specimen.id = run.specimen_id JOIN rig ON rig.id = run.rig_id ";

template <class Row, class Bind>
std::vector<Row> rowsOf(Statement& statement, Bind bind) {
  const Reading reading(statement);
  bind(statement);
  std::vector<Row> rows;
  while (statement.step()) rows.push_back(readRow<Row>(statement));
  return rows;
}

std::vector<FrameRow> framesOf(Statement& statement) {
  std::vector<FrameRow> frames;
  while (statement.step()) frames.push_back(readRow<FrameRecord>(statement).row);
  return frames;
}

std::vector<RunRow> runsOf(Statement& statement) {
  constexpr int kRunColumns = 14;
  std::vector<RunRow> runs;
  while (statement.step()) {
    RunRow run = readRow<RunRecord>(statement).row;
    run.specimen = statement.text(kRunColumns);
    run.rig = statement.text(kRunColumns + 1);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::string sqlOfFrames(Query query) {
  const std::string frame = columnList<FrameRecord>("frame.");
  switch (query) {
    case Query::kFramesOfStep:
      return selectFrom(frame,
                        "shot JOIN frame ON frame.shot_id = shot.id WHERE shot.step_id = ? "
                        "ORDER BY shot.id, frame.file_index");
    case Query::kNewestFrame:
      return selectFrom(frame, "frame WHERE run_id = ? ORDER BY id DESC LIMIT 1");
    case Query::kFramesBetween:
      return selectFrom(frame,
                        "frame WHERE run_id = ? AND utc_ns >= ? AND utc_ns < ? "
                        "ORDER BY utc_ns, id");
    case Query::kFrameBySha256:
      return selectFrom(frame, "frame WHERE sha256 = ? LIMIT 1");
    case Query::kFramesPage:
      return selectFrom(columnList<ShotRow>("shot.") + ", " + frame,
                        "frame JOIN shot ON shot.id = frame.shot_id WHERE frame.run_id = ? AND "
                        "frame.id > ? ORDER BY frame.id LIMIT ?");
    default:
      return selectFrom(
          columnList<StepRow>("step.") + ", " + columnList<ShotRow>("shot.") + ", " + frame,
          "step CROSS JOIN shot ON shot.step_id = step.id CROSS JOIN frame ON "
          "frame.shot_id = shot.id WHERE step.run_id = ? ORDER BY step.number");
  }
}

}  // namespace

std::string sqlOf(Query query) {
  switch (query) {
    case Query::kRuns:
      return selectFrom(runList(), kRunTables) + "ORDER BY run.number";
    case Query::kRunsByPrefix:
      return selectFrom(runList(), kRunTables) +
             "WHERE run.id >= ?1 AND run.id < ?1 || char(1114111) ORDER BY run.id";
    case Query::kSteps:
      return selectFrom(columnList<StepRow>(), "step WHERE run_id = ? ORDER BY number, id");
    case Query::kStepsDecided:
      return selectFrom(columnList<StepRow>(),
                        "step WHERE run_id = ? AND decision = ? ORDER BY number, id");
    case Query::kStep:
      return selectFrom(columnList<StepRow>(), "step WHERE run_id = ? AND number = ?");
    case Query::kLastNumber:
      return "SELECT max(number) FROM step WHERE run_id = ?";
    case Query::kUnfinished:
      return selectFrom(columnList<StepRow>(),
                        "step WHERE run_id = ? AND decision = 'pending' ORDER BY number DESC, id "
                        "DESC LIMIT 1");
    case Query::kRunOfStep:
      return "SELECT run_id FROM step WHERE id = ?";
    case Query::kShotsOfStep:
      return selectFrom(columnList<ShotRow>(), "shot WHERE step_id = ? ORDER BY id");
    case Query::kLightChecks:
      return selectFrom(columnList<LightCheckRow>(), "light_check WHERE run_id = ? ORDER BY id");
    case Query::kLightChecksOfShot:
      return selectFrom(columnList<LightCheckRow>(), "light_check WHERE shot_id = ? ORDER BY id");
    case Query::kReadings:
      return selectFrom(columnList<ReadingRow>(), "reading WHERE run_id = ? ORDER BY id");
    case Query::kEvents:
      return selectFrom(columnList<EventRow>(), "event WHERE run_id IS ? ORDER BY id");
    case Query::kCalibrations:
      return selectFrom(columnList<CalibrationRow>(), "calibration ORDER BY id");
    case Query::kCalibrationsOfKind:
      return selectFrom(columnList<CalibrationRow>(), "calibration WHERE kind = ? ORDER BY id");
    case Query::kProducts:
      return selectFrom(columnList<ProductRow>(), "product ORDER BY created_utc_ns, id");
    case Query::kProductsOfKind:
      return selectFrom(columnList<ProductRow>(),
                        "product WHERE kind = ? ORDER BY created_utc_ns, id");
    case Query::kProductInputs:
      return "SELECT sha256 FROM product_input WHERE product_id = ? ORDER BY position";
    case Query::kDevices:
      return selectFrom(columnList<DeviceRow>(), "device ORDER BY id");
    case Query::kStepsByHand:
      return selectFrom(columnList<StepRow>(),
                        "step WHERE run_id = ? AND number IS NULL ORDER BY id LIMIT ?");
    case Query::kStepsPage:
      return selectFrom(columnList<StepRow>(),
                        "step WHERE run_id = ? AND number > ? ORDER BY number LIMIT ?");
    case Query::kLightChecksPage:
      return selectFrom(columnList<LightCheckRow>(),
                        "light_check WHERE run_id = ? AND id > ? ORDER BY id LIMIT ?");
    case Query::kEventsPage:
      return selectFrom(columnList<EventRow>(),
                        "event WHERE run_id = ? AND id > ? ORDER BY id LIMIT ?");
    case Query::kArmedShots:
      return selectFrom(columnList<ShotRow>(), "shot WHERE state = 'armed' ORDER BY id");
    case Query::kShotOfKey:
      return selectFrom("1",
                        "shot WHERE step_id = ? AND device_id = ? AND light_state = ? AND "
                        "exposure_index = ? AND attempt = ?");
    default:
      return sqlOfFrames(query);
  }
}

Statement& ArchiveReader::State::statement(Query query) {
  Statement& statement = statements[static_cast<std::size_t>(query)];
  if (!statement) statement = Statement(*database, sqlOf(query));
  return statement;
}

ArchiveReader::ArchiveReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
ArchiveReader::~ArchiveReader() = default;
ArchiveReader::ArchiveReader(ArchiveReader&&) noexcept = default;

ArchiveReader::ArchiveReader(const std::filesystem::path& folder)
    : state_(std::make_unique<State>()) {
  state_->folder = std::filesystem::absolute(folder);
  const auto file = state_->folder / "catalog.sqlite";
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw ArchiveError(Exit::kBadData,
                       folder.string() + " is no archive: it has no " + file.filename().string());
  state_->database = openForReading(file);
  checkVersion(*state_->database);
}

const std::filesystem::path& ArchiveReader::folder() const { return state_->folder; }

std::vector<RunRow> ArchiveReader::runs() const {
  const auto guard = state_->guard();
  Statement& statement = state_->statement(Query::kRuns);
  const Reading reading(statement);
  return runsOf(statement);
}

RunRow ArchiveReader::findRun(const std::string& wanted) const {
  const auto guard = state_->guard();
  const auto choices = [](const std::vector<RunRow>& some) {
    std::string list;
    constexpr std::size_t kShown = 8;
    for (std::size_t i = 0; i < some.size() && i < kShown; ++i)
      list += (i == 0 ? "" : ", ") + some[i].id;
    return some.size() > kShown ? list + ", ..." : list;
  };
  if (wanted == "latest") {
    auto all = runs();
    if (all.empty()) throw ArchiveError(Exit::kUsage, folder().string() + " holds no run yet");
    return all.back();
  }
  Statement& statement = state_->statement(Query::kRunsByPrefix);
  const Reading reading(statement);
  statement.bind(1, wanted);
  auto found = runsOf(statement);
  for (auto& run : found)
    if (run.id == wanted) return run;
  if (found.size() == 1) return found.front();
  throw ArchiveError(Exit::kUsage, found.empty()
                                       ? "no run '" + wanted + "' in " + folder().string() +
                                             "; there are: " + choices(runs())
                                       : "'" + wanted + "' could be " + choices(found));
}

std::vector<StepRow> ArchiveReader::steps(const std::string& run_id,
                                          std::optional<Decision> decision) const {
  const auto guard = state_->guard();
  return rowsOf<StepRow>(state_->statement(decision ? Query::kStepsDecided : Query::kSteps),
                         [&](Statement& s) {
                           s.bind(1, run_id);
                           if (decision) s.bind(2, std::string_view(name(*decision)));
                         });
}

std::optional<StepRow> ArchiveReader::step(const std::string& run_id, std::int64_t number) const {
  const auto guard = state_->guard();
  auto rows = rowsOf<StepRow>(state_->statement(Query::kStep),
                              [&](Statement& s) { s.bind(1, run_id).bind(2, number); });
  if (rows.empty()) return std::nullopt;
  return std::move(rows.front());
}

std::vector<ShotRow> ArchiveReader::shotsOfStep(RowId step_id) const {
  const auto guard = state_->guard();
  return rowsOf<ShotRow>(state_->statement(Query::kShotsOfStep),
                         [&](Statement& s) { s.bind(1, step_id); });
}

std::vector<FrameRow> ArchiveReader::framesOfStep(RowId step_id) const {
  const auto guard = state_->guard();
  Statement& statement = state_->statement(Query::kFramesOfStep);
  const Reading reading(statement);
  statement.bind(1, step_id);
  return framesOf(statement);
}

std::optional<FrameRow> ArchiveReader::newestFrame(const std::string& run_id) const {
  const auto guard = state_->guard();
  Statement& statement = state_->statement(Query::kNewestFrame);
  const Reading reading(statement);
  statement.bind(1, run_id);
  auto frames = framesOf(statement);
  if (frames.empty()) return std::nullopt;
  return std::move(frames.front());
}

std::vector<FrameRow> ArchiveReader::framesBetween(const std::string& run_id, UtcTime from,
                                                   UtcTime to) const {
  const auto guard = state_->guard();
  Statement& statement = state_->statement(Query::kFramesBetween);
  const Reading reading(statement);
  statement.bind(1, run_id).bind(2, toNs(from)).bind(3, toNs(to));
  return framesOf(statement);
}

std::vector<LightCheckRow> ArchiveReader::lightChecks(const std::string& run_id) const {
  const auto guard = state_->guard();
  return rowsOf<LightCheckRow>(state_->statement(Query::kLightChecks),
                               [&](Statement& s) { s.bind(1, run_id); });
}

std::vector<LightCheckRow> ArchiveReader::lightChecksOfShot(RowId shot_id) const {
  const auto guard = state_->guard();
  return rowsOf<LightCheckRow>(state_->statement(Query::kLightChecksOfShot),
                               [&](Statement& s) { s.bind(1, shot_id); });
}

std::vector<ReadingRow> ArchiveReader::readings(const std::string& run_id) const {
  const auto guard = state_->guard();
  return rowsOf<ReadingRow>(state_->statement(Query::kReadings),
                            [&](Statement& s) { s.bind(1, run_id); });
}

std::vector<EventRow> ArchiveReader::events(const std::string& run_id) const {
  const auto guard = state_->guard();
  return rowsOf<EventRow>(state_->statement(Query::kEvents), [&](Statement& s) {
    run_id.empty() ? s.bindNull(1) : s.bind(1, run_id);
  });
}

std::vector<CalibrationRow> ArchiveReader::calibrations(const std::string& kind) const {
  const auto guard = state_->guard();
  return rowsOf<CalibrationRow>(
      state_->statement(kind.empty() ? Query::kCalibrations : Query::kCalibrationsOfKind),
      [&](Statement& s) {
        if (!kind.empty()) s.bind(1, kind);
      });
}

std::vector<ProductRow> ArchiveReader::products(const std::string& kind) const {
  const auto guard = state_->guard();
  auto rows = rowsOf<ProductRow>(
      state_->statement(kind.empty() ? Query::kProducts : Query::kProductsOfKind),
      [&](Statement& s) {
        if (!kind.empty()) s.bind(1, kind);
      });
  Statement& inputs = state_->statement(Query::kProductInputs);
  for (auto& row : rows) {
    const Reading reading(inputs);
    inputs.bind(1, row.id);
    while (inputs.step()) row.input_sha256s.emplace_back(inputs.text(0));
  }
  return rows;
}

void ArchiveReader::eachFrame(const std::string& run_id,
                              const std::function<void(const CapturedFrame&)>& each) const {
  const auto guard = state_->guard();
  // A statement of its own: `each` may ask this reader again.
  Statement statement(*state_->database, sqlOf(Query::kEachFrame));
  statement.bind(1, run_id);
  while (statement.step()) {
    CapturedFrame found;
    RowReader reader(statement);
    columns(reader, found.step);
    columns(reader, found.shot);
    FrameRecord frame;
    columns(reader, frame);
    found.frame = frame.row;
    each(found);
  }
}

std::filesystem::path ArchiveReader::pathOf(const FrameRow& frame) const {
  return folder() / framePath(frame.sha256, frame.ext);
}

Bytes ArchiveReader::read(const FrameRow& frame) const {
  const auto path = pathOf(frame);
  Bytes bytes;
  try {
    bytes = readFile(path);
  } catch (const ProcessingError& e) {
    throw ArchiveError(e.exit(), e.what());
  }
  if (sha256(bytes) != frame.sha256)
    throw ArchiveError(Exit::kBadData, path.string() +
                                           " does not match its name: it has changed "
                                           "since it was acknowledged");
  return bytes;
}

}  // namespace patina::db
