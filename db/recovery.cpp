// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/recovery.h"

#include <algorithm>
#include <cerrno>

#include "db/errors.h"
#include "db/journal_rewrite.h"
#include "db/trash.h"

namespace patina::db {
namespace {

using How = Change::How;

std::int64_t sizeOf(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

const FrameRecord* frameOf(const AnyRow& row) { return std::get_if<FrameRecord>(&row); }

bool isWhole(const std::filesystem::path& archive, const FrameRow& frame) {
  const auto path = archive / framePath(frame.sha256, frame.ext);
  if (sizeOf(path) != frame.bytes || !std::filesystem::exists(path)) return false;
  try {
    return sha256OfFile(path) == frame.sha256;
  } catch (const ProcessingError&) {
    return false;
  }
}

}  // namespace

int sweepTemporaries(FileOps& files, const std::filesystem::path& archive) {
  int swept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(archive / "tmp")) {
    checkDisk(files.remove(entry.path()), "sweeping", entry.path());
    ++swept;
  }
  return swept;
}

bool hasItsFrames(const std::filesystem::path& archive, const JournalBatch& batch) {
  return std::ranges::all_of(batch.rows, [&](const AnyRow& row) {
    return frameOf(row) == nullptr || isWhole(archive, frameOf(row)->row);
  });
}

void cutJournal(FileOps& files, const std::filesystem::path& path, std::int64_t size) {
  std::unique_ptr<File> file;
  checkDisk(files.open(path, FileOps::Mode::kUpdate, &file), "opening", path);
  checkDisk(file->truncate(size), "cutting", path);
  checkDisk(file->sync(), "syncing", path);
}

namespace {

// What a process wrote and could not sync may be in the kernel's memory alone and called clean
// there (fsync(2), EIO): a sync would say yes to nothing. Written again, it is dirty again.
void writeAgain(FileOps& files, const std::filesystem::path& path, std::int64_t from,
                std::int64_t to) {
  std::unique_ptr<File> file;
  checkDisk(files.open(path, FileOps::Mode::kUpdate, &file), "opening", path);
  Bytes part(std::min<std::int64_t>(to - from, 1 << 20));
  while (from < to) {
    const auto span = std::span(part).first(std::min<std::int64_t>(to - from, part.size()));
    const std::int64_t got = file->read(span, from);
    if (got <= 0) throwDiskError(got < 0 ? static_cast<int>(-got) : EIO, "reading", path);
    auto left = std::span(part).first(static_cast<std::size_t>(got));
    while (!left.empty()) {
      const std::int64_t put = file->write(left, from);
      if (put <= 0) throwDiskError(put < 0 ? static_cast<int>(-put) : ENOSPC, "writing", path);
      from += put;
      left = left.subspan(static_cast<std::size_t>(put));
    }
  }
  checkDisk(file->sync(), "syncing", path);
}

class Recovery {
 public:
  explicit Recovery(Archive::State& state) : s_(state), archive_(state.options.folder) {}

  void run() {
    s_.report.tmp_swept = sweepTemporaries(*s_.files, archive_);
    auto tails = readTails(*s_.files, archive_, *s_.database, *s_.writer);
    returnNamedFrames(*s_.files, archive_, *s_.database, tails);
    // The last lines may have been written before their frames found their places; they were not
    // acknowledged then, and go.
    std::vector<JournalBatch> dropped;
    for (JournalTail& tail : tails)
      if (!tail.batches.empty() && !hasItsFrames(archive_, tail.batches.back())) {
        dropped.push_back(std::move(tail.batches.back()));
        tail.batches.pop_back();
      }
    // Before anything is written to a journal: its time tells which frames are newer.
    const auto orphans =
        quarantineOrphans(*s_.files, archive_, *s_.database, tails, OrphanSearch::kNewest, dropped);
    merge(tails);
    s_.loadIds();
    const UtcTime last = lastKnownTime();
    for (const std::string& name : orphans)
      s_.addEvent({0, {}, last, "quarantine", "frames file without a row: " + name});
    s_.report.frames_quarantined = static_cast<int>(orphans.size());
    loseArmedShots();
    // `verify` looks at all of them; a start looks at those that a power cut could have reached.
    constexpr std::int64_t kNewest = 64;
    markMissing(s_, kNewest);
  }

 private:
  void merge(const std::vector<JournalTail>& tails) {
    std::map<std::string, std::int64_t> marks;
    for (const JournalTail& tail : tails) {
      const std::int64_t whole = tail.batches.empty() ? tail.mark : tail.batches.back().end;
      if (tail.size < tail.mark)
        marks[tail.name] = rewriteJournal(*s_.files, archive_, *s_.database, tail.name);
      else if (whole < tail.size)
        cutJournal(*s_.files, journalPath(archive_, tail.name), whole);
      if (tail.batches.empty()) continue;
      writeAgain(*s_.files, journalPath(archive_, tail.name), tail.mark, whole);
      keepNamesOf(tail);
      marks[tail.name] = whole;
    }
    if (marks.empty()) return;
    // One transaction: the lines of a run refer to the shared journal's, and those to runs'.
    Transaction transaction(*s_.database);
    s_.database->run("PRAGMA defer_foreign_keys=ON");
    for (const JournalTail& tail : tails)
      for (const JournalBatch& batch : tail.batches)
        for (const AnyRow& row : batch.rows) {
          s_.writer->replay(row);
          ++s_.report.rows_from_journal;
          if (frameOf(row)) ++s_.report.frames_adopted;
        }
    for (const auto& [name, bytes] : marks) s_.writer->mark(name, bytes);
    transaction.commit();
  }

  // A frame is adopted by its line although its process died before the name was synced.
  void keepNamesOf(const JournalTail& tail) {
    std::set<std::filesystem::path> folders;
    for (const JournalBatch& batch : tail.batches)
      for (const AnyRow& row : batch.rows)
        if (const FrameRecord* frame = frameOf(row))
          folders.insert((archive_ / framePath(frame->row.sha256, frame->row.ext)).parent_path());
    for (const auto& folder : folders)
      if (std::filesystem::exists(folder))
        checkDisk(s_.files->syncFolder(folder), "syncing", folder);
    if (!folders.empty())
      checkDisk(s_.files->syncFolder(archive_ / "frames"), "syncing", archive_ / "frames");
  }

  // Recovery reads no clock: its events carry the last time the archive knows.
  UtcTime lastKnownTime() const {
    return utcFromNs(s_.database->number(
        "SELECT max((SELECT coalesce(max(utc_ns), 0) FROM (SELECT utc_ns FROM event ORDER BY id "
        "DESC LIMIT 1)), (SELECT coalesce(max(acked_utc_ns), 0) FROM (SELECT acked_utc_ns FROM "
        "frame ORDER BY id DESC LIMIT 1)))"));
  }

  void loseArmedShots() {
    std::vector<ShotRow> armed;
    {
      Statement statement(*s_.database, sqlOf(Query::kArmedShots));
      while (statement.step()) armed.push_back(readRow<ShotRow>(statement));
    }
    for (ShotRow shot : armed) {
      const std::string run_id = s_.runOfStep(shot.step_id);
      shot.state = ShotState::kLost;
      Change change;
      change.add(How::kSettleShot, shot);
      change.add(How::kInsert, EventRow{s_.next.event++, run_id, shot.began_utc, "shot_lost",
                                        shot.device_id + " " + shot.light_state +
                                            ": the process ended before its frame was committed"});
      s_.commit(run_id, change);
      ++s_.report.shots_lost;
    }
  }

  Archive::State& s_;
  std::filesystem::path archive_;
};

}  // namespace

std::vector<JournalTail> readTails(FileOps& files, const std::filesystem::path& archive,
                                   Database& database, CatalogueWriter& writer) {
  std::set<std::string> names;
  for (const auto& name : journalNames(archive)) names.insert(name);
  {
    Statement marks(database, "SELECT journal FROM journal_mark");
    while (marks.step()) names.emplace(marks.text(0));
  }
  std::vector<JournalTail> tails;
  for (const auto& name : names) {
    JournalTail tail{name, writer.markOf(name), sizeOf(journalPath(archive, name)), {}};
    if (tail.size > tail.mark)
      scanJournal(files, journalPath(archive, name), tail.mark, tail.size,
                  [&](JournalBatch&& batch) {
                    if (batch.bad_lines == 0) tail.batches.push_back(std::move(batch));
                  });
    if (tail.size != tail.mark) tails.push_back(std::move(tail));
  }
  return tails;
}

void markMissing(Archive::State& s, std::int64_t limit) {
  std::vector<FrameRecord> changed;
  s.report.frames_missing = 0;
  {
    Statement statement(*s.database, "SELECT " + columnList<FrameRecord>() +
                                         " FROM frame ORDER BY id DESC LIMIT ?");
    statement.bind(1, limit);
    while (statement.step()) {
      auto frame = readRow<FrameRecord>(statement);
      const auto path = s.options.folder / framePath(frame.row.sha256, frame.row.ext);
      const bool gone = sizeOf(path) != frame.row.bytes;
      if (gone) ++s.report.frames_missing;
      if (gone != frame.row.missing) changed.push_back(std::move(frame));
    }
  }
  for (FrameRecord& frame : changed) {
    frame.row.missing = !frame.row.missing;
    Change change;
    change.add(How::kUpsert, frame);
    change.add(How::kInsert, EventRow{s.next.event++, frame.run_id, frame.row.acked_utc,
                                      frame.row.missing ? "frame_missing" : "frame_found",
                                      framePath(frame.row.sha256, frame.row.ext).string()});
    s.commit(frame.run_id, change);
  }
}

void recover(Archive::State& state) { Recovery(state).run(); }

}  // namespace patina::db
