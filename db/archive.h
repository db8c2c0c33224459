// SPDX-License-Identifier: GPL-3.0-or-later
// The archive: catalogue, journal, frames, products (design, section 3).
//
// Promise: a frame is acknowledged when acknowledge() returns, and then never lost, overwritten or
// rewritten. Order inside: file written and fsynced under tmp/, renamed to its hash without
// replacing, folder fsynced, journal line fsynced, row committed (WAL, synchronous=FULL).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "db/failure.h"
#include "db/file_ops.h"
#include "db/rows.h"
#include "processing/image/picture_file.h"
#include "processing/image/progress.h"

namespace patina::db {

// Where a commit stands; tests kill the process there.
enum class CommitPoint {
  kShotArmed,
  kTmpWritten,
  kTmpSynced,
  kRenamed,
  kFolderSynced,
  kJournalSynced,
  kCommitted
};
constexpr int kCommitPointCount = 7;
const char* name(CommitPoint p);

struct ArchiveOptions {
  std::filesystem::path folder;
  FileOps* files = nullptr;                   // default realFileOps()
  std::function<void(CommitPoint)> at_point;  // may not return
  std::string owner;                          // "patina capture banana.toml": named in the lock
  bool allow_network_file_system = false;
  // Mutants for the tests of the power cut: each leaves out one promise.
  enum class Mutant { kNone, kNoFileSync, kNoFolderSync, kSynchronousNormal };
  Mutant mutant = Mutant::kNone;
};

struct PendingFrame {
  int file_index = 0;
  std::string ext;
  std::span<const std::byte> bytes;
  SizePx size;
  UtcTime utc;
  MonoTime mono;
  double saturated_fraction = 0;
};

struct RecoveryReport {
  int tmp_swept = 0, rows_from_journal = 0, frames_adopted = 0, frames_quarantined = 0,
      shots_lost = 0, frames_missing = 0;
};

struct RunState {  // what a restarted session needs
  RunRow run;
  std::optional<std::int64_t> last_number;  // of the steps that have a row
  std::optional<StepRow> unfinished;        // pending: the process died in it
};

// Read side: any process, any time, also while another one captures. Thread-bound.
class ArchiveReader {
 public:
  explicit ArchiveReader(const std::filesystem::path& folder);  // ArchiveError if there is none
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;

  const std::filesystem::path& folder() const;
  std::vector<RunRow> runs() const;                              // in the order they were added
  RunRow findRun(const std::string& id_prefix_or_latest) const;  // kUsage with the choices
  std::vector<StepRow> steps(const std::string& run_id, std::optional<Decision> = {}) const;
  std::optional<StepRow> step(const std::string& run_id, std::int64_t number) const;
  std::vector<ShotRow> shotsOfStep(RowId step_id) const;
  std::vector<FrameRow> framesOfStep(RowId step_id) const;
  std::optional<FrameRow> newestFrame(const std::string& run_id) const;
  std::vector<FrameRow> framesBetween(const std::string& run_id, UtcTime from, UtcTime to) const;
  std::vector<LightCheckRow> lightChecks(const std::string& run_id) const;
  std::vector<LightCheckRow> lightChecksOfShot(RowId shot_id) const;
  std::vector<ReadingRow> readings(const std::string& run_id) const;
  std::vector<EventRow> events(const std::string& run_id) const;
  std::vector<CalibrationRow> calibrations(const std::string& kind = {}) const;
  std::vector<ProductRow> products(const std::string& kind = {}) const;
  // Every captured shot of a run with its frame and step, in order of step; streamed.
  struct CapturedFrame {
    StepRow step;
    ShotRow shot;
    FrameRow frame;
  };
  void eachFrame(const std::string& run_id, const std::function<void(const CapturedFrame&)>&) const;

  std::filesystem::path pathOf(const FrameRow& frame) const;
  Bytes read(const FrameRow& frame) const;  // checks the hash: kBadData when it does not match

  struct State;  // of db/ itself

 private:
  friend class Archive;
  explicit ArchiveReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// The one owner (flock, dies with the process). Opens or creates, migrates, recovers. Thread-bound.
// After DiskFull the archive goes on as soon as there is room. After a kIo of journal or catalogue
// it refuses every further change: end the process (or make a new Archive), which recovers.
class Archive {
 public:
  explicit Archive(const ArchiveOptions& options);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  const RecoveryReport& recovery() const;
  const ArchiveReader& reader() const;  // same connection: sees uncommitted nothing

  void beginRun(const RunRow& run, const SpecimenRow& specimen);
  void setRunState(const std::string& run_id, const std::string& state);
  std::optional<RunState> runState(const std::string& run_id) const;

  void addDevice(const DeviceRow& device);  // or update; a shot's or reading's device is added bare
  // A decided step is committed whole. A pending one is written by the next commit of any kind
  // (armShot, as a rule): a crash before that leaves no trace of it.
  RowId beginStep(const StepRow& step);
  void addSteps(std::span<const StepRow> decided);  // many in one transaction: gaps, imports
  void finishStep(const StepRow& step);             // by id
  RowId armShot(const ShotRow& shot);               // before the trigger
  // All files of one shot in one transaction with the shot's row and its verdicts. The promise.
  // With `finished`, the step's finishStep() rides in the same transaction: one commit less.
  std::vector<FrameRow> acknowledge(const ShotRow& shot, std::span<const PendingFrame> frames,
                                    std::span<const LightCheckRow> checks, UtcTime now,
                                    const StepRow* finished = nullptr);
  void failShot(const ShotRow& shot, const std::string& reason);
  void addLightChecks(std::span<const LightCheckRow> checks);
  void addReading(const ReadingRow& reading);
  void addReadings(std::span<const ReadingRow> readings);
  void addEvent(const EventRow& event);
  // Bytes that are no frame, kept with a name that says why: quarantine/<sha256>.<ext>.
  void quarantine(std::span<const std::byte> bytes, const std::string& ext, const EventRow& why);

  Space space() const;

  struct State;  // of db/ itself

 private:
  std::unique_ptr<State> state_;
};

// Products are added by any process in short transactions beside a capturing one.
struct ProductWriter {
  static std::filesystem::path folderFor(const std::filesystem::path& archive,
                                         const std::string& id);
  static void add(const std::filesystem::path& archive, const ProductRow& product);
  static RowId addCalibration(const std::filesystem::path& archive, const CalibrationRow& row);
  static void bind(const std::filesystem::path& archive, std::span<const FrameCalibrationRow> rows);
};

struct VerifyProblem {
  std::string what;  // "missing" "hash" "size" "row" "journal" "orphan"
  std::string path, detail;
};
struct VerifyReport {
  std::int64_t frames = 0, bytes = 0, rows = 0;
  std::vector<VerifyProblem> problems;
};
VerifyReport verify(const std::filesystem::path& archive, Progress& progress);
// A new catalogue from journal and frames, built beside the old one and exchanged whole.
RecoveryReport rebuild(const std::filesystem::path& archive, Progress& progress);

}  // namespace patina::db
