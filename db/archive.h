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

#include "db/archive_care.h"
#include "db/archive_reader.h"
#include "db/failure.h"
#include "db/file_ops.h"
#include "db/product_writer.h"
#include "db/rows.h"
#include "processing/image/picture_file.h"

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

struct RunState {  // what a restarted session needs
  RunRow run;
  std::optional<std::int64_t> last_number;  // of the steps that have a row
  std::optional<StepRow> unfinished;        // pending: the process died in it
};

// The one owner (flock, dies with the process). Opens or creates, migrates, recovers.
//
// Thread-safe: several sessions may share it, each for runs of its own. Every call is whole under
// one lock, which is held while journal and catalogue are synced; a frame's bytes are written
// before it is taken, so a large picture of one run does not delay the trigger of another. Rows of
// one run come from one thread at a time; setRunState and changeRunState from any. `files` and
// `at_point` are called from as many threads as call us.
//
// After DiskFull the archive goes on as soon as there is room. After a kIo of journal or catalogue
// it refuses every further change: end the process (or make a new Archive), which recovers.
class Archive {
 public:
  explicit Archive(const ArchiveOptions& options);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  const RecoveryReport& recovery() const;
  // Same connection and lock: sees uncommitted nothing; eachFrame keeps others waiting.
  const ArchiveReader& reader() const;

  void beginRun(const RunRow& run, const SpecimenRow& specimen);
  void setRunState(const std::string& run_id, const std::string& state);
  // Only from one of the states `from`; answers whether it was. What a person asks for, while a
  // session may be ending, is written so before it is acted on.
  bool changeRunState(const std::string& run_id, const std::vector<std::string>& from,
                      const std::string& to);
  std::optional<RunState> runState(const std::string& run_id) const;

  void addDevice(const DeviceRow& device);  // or update; a shot's or reading's device is added bare
  // A decided step is committed whole. A pending one is written by the next change of any kind
  // (armShot, as a rule): a crash before that leaves no trace of it.
  RowId beginStep(const StepRow& step);
  void addSteps(std::span<const StepRow> decided);  // many in one transaction: gaps, imports
  void finishStep(const StepRow& step);             // by id
  // Before the trigger. Promised by the journal alone: one fsync between the order and the
  // shutter. Its row enters the table with the next commit of its run, or by recovery.
  RowId armShot(const ShotRow& shot);
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
  // After a full disk: the file that is given up for the last rows of the next one.
  void renewReserve();

  struct State;  // of db/ itself

 private:
  std::unique_ptr<State> state_;
};

}  // namespace patina::db
