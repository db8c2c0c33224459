// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/scrub.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "db/care/background.h"
#include "db/care/gc_marks.h"
#include "db/care/scrub_rounds.h"
#include "db/errors.h"
#include "db/frame_store.h"
#include "db/lock.h"
#include "db/product_writer.h"
#include "db/row_statements.h"
#include "db/schema.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;

class Scrub {
 public:
  Scrub(const fs::path& archive, const ScrubOptions& options, Progress& progress)
      : archive_(fs::absolute(archive).lexically_normal()),
        options_(options),
        files_(options.files ? *options.files : realFileOps()),
        progress_(progress) {
    const auto file = archive_ / "catalog.sqlite";
    if (!fs::exists(file))
      throw ArchiveError(Exit::kBadData,
                         archive.string() + " is no archive: it has no catalog.sqlite");
    lock();
    catalogue_ = openForReading(file);
    checkVersion(*catalogue_);
    rounds_ = ScrubRounds::parse(readWhole(files_, statePath()));
    last_id_ = catalogue_->number("SELECT max(id) FROM frame");
  }

  ScrubReport run() {
    giveWay();
    began_ = options_.mono();
    slice_at_ = options_.utc();
    const auto due = rounds_.due(last_id_);
    progress_.begin("frames", catalogue_->number("SELECT count(*) FROM frame"));
    try {
      for (const Range& range : due)
        if (!check(range)) break;
    } catch (const Stopped&) {
      remember();
      throw;
    }
    summarise();
    remember();
    return std::move(report_);
  }

 private:
  fs::path statePath() const { return archive_ / "care" / "scrub"; }

  // A medium that cannot be written can still be read.
  void lock() {
    try {
      lock_ = takeCareLock(files_, archive_, options_.owner);
    } catch (const ArchiveError& e) {
      if (e.exit() != Exit::kCannotCreate && e.exit() != Exit::kPermission) throw;
      report_.remembered = false;
    }
  }

  bool timeIsUp() const { return options_.mono() - began_ >= options_.max_duration; }

  // False when the time is up; what was looked at counts.
  bool check(const Range& range) {
    constexpr std::int64_t kTogether = 512;
    for (std::int64_t first = range.first; first <= range.last; first += kTogether) {
      std::vector<FrameRecord> frames;
      {
        Statement rows(*catalogue_, "SELECT " + columnList<FrameRecord>() +
                                        " FROM frame WHERE id BETWEEN ? AND ? ORDER BY id");
        rows.bind(1, first).bind(2, std::min(range.last, first + kTogether - 1));
        while (rows.step()) frames.push_back(readRow<FrameRecord>(rows));
      }
      for (const FrameRecord& frame : frames) {
        if (report_.frames > 0 && timeIsUp()) {
          if (frame.row.id > first) note({first, frame.row.id - 1});
          return false;
        }
        progress_.step();
        check(frame);
      }
      note({first, std::min(range.last, first + kTogether - 1)});
    }
    return true;
  }

  void check(const FrameRecord& frame) {
    const auto path = archive_ / framePath(frame.row.sha256, frame.row.ext);
    const auto add = [&](const char* what, const std::string& detail) {
      report_.problems.push_back({what, path.string(), frame.run_id, detail, frame.row.id});
    };
    ++report_.frames;
    std::unique_ptr<File> file;
    const int opened = files_.open(path, FileOps::Mode::kRead, &file);
    if (opened == -ENOENT) return add("missing", "is not there");
    if (opened < 0) return add("unreadable", std::strerror(-opened));
    const std::int64_t size = file->size();
    if (size != frame.row.bytes)
      return add("size",
                 std::to_string(size) + " bytes instead of " + std::to_string(frame.row.bytes));
    file->dropCache();
    Sha256Stream hash;
    for (std::int64_t at = 0; at < size;) {
      const std::int64_t got = file->read(piece_, at);
      if (got <= 0) return add("unreadable", std::strerror(got < 0 ? static_cast<int>(-got) : EIO));
      hash.add(std::span(piece_).first(static_cast<std::size_t>(got)));
      at += got;
    }
    file->dropCache();  // what the capturing process keeps in memory matters more
    report_.bytes += size;
    if (hash.finish() != frame.row.sha256) add("hash", "is not what it was");
  }

  void note(Range range) {
    fresh_.push_back(range);
    constexpr std::size_t kRangesTogether = 8;
    if (fresh_.size() >= kRangesTogether) remember();
  }

  // Damage first, then that it was looked at.
  void remember() {
    if (!report_.remembered) return;
    try {
      for (; told_ < report_.problems.size(); ++told_) {
        const ScrubProblem& p = report_.problems[told_];
        events_.push_back({0,
                           {},
                           slice_at_,
                           "scrub_damage",
                           p.what + " " + p.path + " of run " + p.run_id + ", frame " +
                               std::to_string(p.frame_id) + ": " + p.detail});
      }
      ProductWriter::addEvents(archive_, events_);
      events_.clear();
      for (const Range& range : fresh_) rounds_.checked(range, slice_at_);
      fresh_.clear();
      writeWhole(files_, statePath(), rounds_.text());
    } catch (const ArchiveError& e) {
      if (e.exit() != Exit::kCannotCreate && e.exit() != Exit::kPermission) throw;
      report_.remembered = false;  // full or read-only
    }
  }

  void summarise() {
    ScrubRounds after = rounds_;
    for (const Range& range : fresh_) after.checked(range, slice_at_);
    for (const Range& gap : after.unchecked(last_id_)) {
      Statement count(*catalogue_, "SELECT count(*) FROM frame WHERE id BETWEEN ? AND ?");
      count.bind(1, gap.first).bind(2, gap.last).step();
      report_.unchecked += count.integer(0);
    }
    if (report_.unchecked == 0 && report_.frames > 0) report_.oldest_check = after.oldest();
    events_.push_back({0,
                       {},
                       slice_at_,
                       "scrub",
                       std::to_string(report_.frames) + " frames, " +
                           formatBytes(static_cast<std::uint64_t>(report_.bytes)) + ", " +
                           std::to_string(report_.problems.size()) + " damaged; " +
                           std::to_string(report_.unchecked) + " never checked"});
  }

  fs::path archive_;
  const ScrubOptions& options_;
  FileOps& files_;
  Progress& progress_;
  std::unique_ptr<FileLock> lock_;
  std::shared_ptr<Database> catalogue_;
  ScrubRounds rounds_;
  std::int64_t last_id_ = 0;
  MonoTime began_;
  UtcTime slice_at_;
  Bytes piece_ = Bytes(1 << 20);
  std::vector<Range> fresh_;      // looked at, not yet written down
  std::vector<EventRow> events_;  // of them
  std::size_t told_ = 0;
  ScrubReport report_;
};

}  // namespace

ScrubReport scrub(const fs::path& archive, const ScrubOptions& options, Progress& progress) {
  return Scrub(archive, options, progress).run();
}

}  // namespace patina::db::care
