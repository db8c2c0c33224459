// SPDX-License-Identifier: GPL-3.0-or-later
// What an open Archive is made of, shared by the files that implement it. Internal to db/.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "db/archive.h"
#include "db/catalogue_read.h"
#include "db/catalogue_write.h"
#include "db/frame_store.h"
#include "db/journal.h"
#include "db/journal_lines.h"

namespace patina::db {

// Rows of one transaction: the journal's lines and what is done to the tables.
struct Change {
  enum class How { kInsert, kUpsert, kSettleShot, kFinishStep };
  template <class Row>
  void add(How how, const Row& row) {
    lines.add(row);
    rows.emplace_back(how, row);
  }
  JournalLines lines;
  using Rows = std::vector<std::pair<How, AnyRow>>;
  Rows rows;
};
void applyRows(CatalogueWriter& writer, const Change::Rows& rows);

// One transaction on rows that belong to no run, beside other processes that may do the same:
// `fill` runs under SQLite's write lock. What a dead process left in the journal is taken over.
void commitShared(Database& database, CatalogueWriter& writer, Journal& shared, FileOps& files,
                  const std::filesystem::path& archive,
                  const std::function<void(Change&, CatalogueWriter&)>& fill);

void checkRunId(const std::string& id);  // it is a file name

struct NextIds {
  RowId step = 1, shot = 1, frame = 1, reading = 1, light_check = 1, event = 1;
};

struct Archive::State {
  // Held by every public call, over everything below. Recursive: eachFrame's caller may ask again.
  mutable std::recursive_mutex mutex;
  ArchiveOptions options;
  FileOps* files = nullptr;
  std::unique_ptr<FileLock> lock;
  std::shared_ptr<Database> database;
  std::unique_ptr<CatalogueWriter> writer;
  std::unique_ptr<ArchiveReader> reader;
  std::unique_ptr<FrameStore> store;
  std::unique_ptr<Journal> shared_journal;
  std::map<std::string, std::unique_ptr<Journal>> run_journals;  // of runs with a session
  RecoveryReport report;
  NextIds next;
  std::map<std::string, StepRow> deferred;  // by run: begun, pending, in no table yet
  // By run: promised by the journal, in no table yet. The run's next commit brings them there.
  std::map<std::string, Change::Rows> ahead;
  std::set<std::string> devices;  // that have a row
  RowId known_step = 0;           // whose run is known_run
  std::string known_run;
  std::map<std::string, std::int64_t> highest_number;  // of the steps of a run; -1: none
  bool broken = false;

  void point(CommitPoint p) const {
    if (options.at_point) options.at_point(p);
  }
  void checkUsable() const;
  Journal& journalOf(const std::string& run_id);  // empty: the shared one
  void closeJournalOf(const std::string& run_id);
  std::string runOfStep(RowId step_id);
  // Throws when the step has its row already. Asks the catalogue only for numbers that go back.
  void checkNewStep(const StepRow& step);
  void checkNewShot(const std::string& run_id, const ShotRow& shot);  // throws: armed before
  void ensureDevice(const std::string& id, const char* kind);
  void insertDevice(const DeviceRow& device);

  // Begins a change of a run's rows with the deferred step, when it is of that run.
  Change changeOf(const std::string& run_id) const;
  // Journal, fsync, BEGIN, rows, COMMIT. On failure nothing of it remains.
  void commit(const std::string& run_id, Change& change);
  // The same for rows that say why we stop: when the disk is full, the reserve gives way.
  void commitSmall(const std::string& run_id, Change& change);
  // Journal and fsync only: a crash loses nothing of it, the tables follow with the next commit.
  void writeAhead(const std::string& run_id, Change& change);
  void writeLines(Journal& journal, Change& change);  // or nothing of them
  void syncJournal(Journal& journal);
  // `undo` and then the lines are taken back, unless the disk failed. In this order: a start finds
  // a line without its frame, but looks for frames without a line only in the newest folders.
  // `undo` answers whether its frames are gone for good.
  void giveUp(Journal& journal, const ArchiveError& error, const std::function<bool()>& undo);
  // Frames that may come back keep their lines, for the next start to judge: nothing is written
  // after them.
  void takeBack(Journal& journal, bool frames_gone) noexcept;
  void commitJournal(Journal& journal, const Change& change,
                     const std::function<void()>& journal_synced,
                     const std::function<bool()>& undo);
  RowId addEvent(const EventRow& event);

  void keepReserve();  // a file that can be given up, so that the end can be noted on a full disk
  bool giveUpReserve();

  void beginRun(const RunRow& run, const SpecimenRow& specimen);

  void prepare();        // folders, lock, probe
  void openCatalogue();  // after prepare()
  void loadIds();
};

// Brings catalogue, journal and frames together after a death at any point; may die itself and be
// run again. Looks only at the journals' tails and at what is newer than they are.
void recover(Archive::State& state);
// Of the `limit` newest frames: whose file is gone is marked so, whose is back is no longer.
void markMissing(Archive::State& state, std::int64_t limit);
// catalog.sqlite anew from the journals, exchanged whole. Between prepare() and openCatalogue().
// False when no catalogue could be read that vouches for the journals' being whole.
bool rebuildCatalogue(Archive::State& state, Progress& progress);
// Rows for the frames and products that no row names, as far as the files tell: rebuild().
void adoptFiles(Archive::State& state, Progress& progress);

}  // namespace patina::db
