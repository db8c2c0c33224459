// SPDX-License-Identifier: GPL-3.0-or-later
// journal/<run_id>.jsonl, and journal/_archive.jsonl for rows that belong to no single run
// (specimens, rigs, devices, calibrations, products). Append-only; one fsync a transaction, before
// its COMMIT. Internal to db/.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "db/columns.h"
#include "db/file_ops.h"

namespace patina::db {

constexpr const char* kSharedJournal = "_archive";

// Opened to append. Thread-bound; one writer at a time (the owner of the archive for runs, the
// holder of SQLite's write lock for the shared one).
class Journal {
 public:
  Journal(FileOps& files, const std::filesystem::path& archive, const std::string& name);

  const std::string& name() const { return name_; }
  std::int64_t size() const { return size_; }  // with what was written and is not settled
  bool pending() const { return size_ != settled_; }
  bool needsRepair() const { return needs_repair_; }  // a tail could not be taken back yet
  std::int64_t sizeOnDisk() const;                    // the shared one grows by other hands too
  void write(const std::string& lines);               // at the end, not synced
  void sync();  // refuses for ever after EIO: another Journal recovers what is there
  void settle() { settled_ = size_; }  // its transaction is committed
  // Cuts off what is pending. Never throws: what fails now is tried again by the next write().
  void takeBack() noexcept;
  // Other processes may have appended to the shared journal, or a dead one left a torn tail.
  void refresh(std::int64_t settled_bytes);

 private:
  void repair();
  std::filesystem::path path_;
  std::string name_;
  std::unique_ptr<File> file_;
  std::int64_t size_ = 0, settled_ = 0;
  bool needs_repair_ = false, sync_failed_ = false;
};

std::filesystem::path journalPath(const std::filesystem::path& archive, const std::string& name);
// Names of the journals that are there, sorted, the shared one first.
std::vector<std::string> journalNames(const std::filesystem::path& archive);

using AnyRow = std::variant<DeviceRow, SpecimenRow, RigRecord, RunRecord, StepRow, ShotRow,
                            FrameRecord, ReadingRow, LightCheckRow, CalibrationRow,
                            FrameCalibrationRow, ProductRow, ProductInputRecord, EventRow>;

struct JournalBatch {
  std::vector<AnyRow> rows;
  std::int64_t begin = 0, end = 0;  // bytes in the file
  int bad_lines = 0;                // in it, whose CRC or content is wrong; left out of rows
};

// Every transaction between two offsets, in order; what has no commit line at the end is left out.
// Answers the offset behind the last whole transaction. O(bytes), streamed.
std::int64_t scanJournal(FileOps& files, const std::filesystem::path& path, std::int64_t from,
                         std::int64_t to, const std::function<void(JournalBatch&&)>& each);

}  // namespace patina::db
