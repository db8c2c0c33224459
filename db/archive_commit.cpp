// SPDX-License-Identifier: GPL-3.0-or-later
// The commit protocol: what happens to a shot between the trigger's order and the acknowledgement.
#include <utility>

#include "db/archive_state.h"
#include "db/errors.h"

namespace patina::db {
namespace {

using How = Change::How;

// Files of one shot on their way to their places; what was placed goes away again when the shot
// is not acknowledged after all.
class Placing {
 public:
  Placing(FrameStore& store, const std::filesystem::path& archive)
      : store_(store), archive_(archive) {}
  ~Placing() { undo(); }
  Placing(const Placing&) = delete;
  Placing& operator=(const Placing&) = delete;

  void write(std::span<const PendingFrame> frames) {
    for (const PendingFrame& frame : frames)
      temporaries_.push_back(store_.writeTemporary(frame.bytes, frame.ext));
  }
  void place(std::span<const PendingFrame> frames, std::span<const FrameRow> rows) {
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (store_.place(temporaries_[i], rows[i].sha256, rows[i].ext, frames[i].bytes))
        placed_.push_back(archive_ / framePath(rows[i].sha256, rows[i].ext));
    temporaries_.clear();
    for (const FrameRow& row : rows) store_.syncFolderOf(row.sha256);
  }
  void keep() {
    temporaries_.clear();
    placed_.clear();
  }
  // False: what was placed may still be there, or come back.
  bool undo() noexcept {
    for (const auto& path : temporaries_) store_.forget(path);
    const bool gone = store_.takeAway(placed_);
    keep();
    return gone;
  }

 private:
  FrameStore& store_;
  std::filesystem::path archive_;
  std::vector<std::filesystem::path> temporaries_, placed_;
};

FrameRow rowOf(const PendingFrame& frame, RowId shot_id, UtcTime now) {
  checkExtension(frame.ext);
  FrameRow row;
  row.shot_id = shot_id;
  row.file_index = frame.file_index;
  row.sha256 = sha256(frame.bytes);
  row.ext = frame.ext;
  row.bytes = static_cast<std::int64_t>(frame.bytes.size());
  row.size = frame.size;
  row.utc = frame.utc;
  row.mono = frame.mono;
  row.acked_utc = now;
  row.saturated_fraction = frame.saturated_fraction;
  return row;
}

}  // namespace

RowId Archive::armShot(const ShotRow& shot) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  s.checkUsable();
  s.ensureDevice(shot.device_id, "camera");
  const std::string run_id = s.runOfStep(shot.step_id);
  s.checkNewShot(run_id, shot);
  ShotRow row = shot;
  row.id = s.next.shot++;
  row.state = ShotState::kArmed;
  Change change = s.changeOf(run_id);
  change.add(How::kInsert, row);
  s.writeAhead(run_id, change);
  s.point(CommitPoint::kShotArmed);
  return row.id;
}

std::vector<FrameRow> Archive::acknowledge(const ShotRow& shot,
                                           std::span<const PendingFrame> frames,
                                           std::span<const LightCheckRow> checks, UtcTime now,
                                           const StepRow* finished) {
  State& s = *state_;
  // Outlives `placing`: what is cleared away is cleared under it, or equal bytes of another run
  // could go with it after they were found in place there.
  std::unique_lock lock(s.mutex);
  s.checkUsable();
  lock.unlock();
  std::vector<FrameRow> rows;
  for (const PendingFrame& frame : frames) rows.push_back(rowOf(frame, shot.id, now));
  Placing placing(*s.store, s.options.folder);
  placing.write(frames);  // most of the time it takes: without the lock

  lock.lock();
  s.checkUsable();
  const std::string run_id = s.runOfStep(shot.step_id);
  for (FrameRow& row : rows) row.id = s.next.frame++;
  Change change = s.changeOf(run_id);
  ShotRow captured = shot;
  captured.state = ShotState::kCaptured;
  change.add(How::kSettleShot, captured);
  for (const FrameRow& row : rows) change.add(How::kInsert, FrameRecord{row, run_id});
  for (LightCheckRow check : checks) {
    check.id = s.next.light_check++;
    change.add(How::kInsert, check);
  }
  if (finished) change.add(How::kFinishStep, *finished);

  // The lines go out before the first rename, so that a file that found its place always has its
  // line: recovery adopts it. They are synced, and thereby promised, only after the folders are.
  Journal& journal = s.journalOf(run_id);
  try {
    journal.write(change.lines.finish());
    placing.place(frames, rows);
  } catch (const ArchiveError& e) {
    s.broken = e.exit() == Exit::kIo;
    s.takeBack(journal, placing.undo());
    throw;
  }
  s.point(CommitPoint::kFolderSynced);
  try {
    s.commitJournal(
        journal, change, [&s] { s.point(CommitPoint::kJournalSynced); },
        [&placing] { return placing.undo(); });
  } catch (const ArchiveError&) {
    placing.keep();
    throw;
  }
  placing.keep();
  s.point(CommitPoint::kCommitted);
  return rows;
}

void Archive::failShot(const ShotRow& shot, const std::string& reason) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  const std::string run_id = s.runOfStep(shot.step_id);
  ShotRow failed = shot;
  failed.state = ShotState::kFailed;
  Change change = s.changeOf(run_id);
  change.add(How::kSettleShot, failed);
  change.add(How::kInsert, EventRow{s.next.event++, run_id, shot.began_utc, "shot_failed",
                                    shot.device_id + " " + shot.light_state + " exposure " +
                                        std::to_string(shot.exposure_index) + " attempt " +
                                        std::to_string(shot.attempt) + ": " + reason});
  s.commitSmall(run_id, change);
}

}  // namespace patina::db
