// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal_rewrite.h"

#include <cerrno>

#include "db/errors.h"
#include "db/journal.h"
#include "db/journal_lines.h"
#include "db/row_statements.h"

namespace patina::db {
namespace {

class Rewriter {
 public:
  Rewriter(FileOps& files, const std::filesystem::path& path, Database& database)
      : path_(path), database_(database) {
    files.remove(path_);
    checkDisk(files.open(path_, FileOps::Mode::kCreate, &file_), "creating", path_);
  }

  // Every row of a table for which `where` holds, one transaction of lines for some thousands.
  template <class Row>
  void table(const std::string& where, const std::string& run_id) {
    Statement rows(database_, "SELECT " + columnList<Row>() + " FROM " + Table<Row>::kName +
                                  " WHERE " + where + " ORDER BY 1, 2");
    if (!run_id.empty()) rows.bind(1, run_id);
    JournalLines lines;
    int count = 0;
    constexpr int kLinesTogether = 4096;
    while (rows.step()) {
      lines.add(readRow<Row>(rows));
      if (++count % kLinesTogether != 0) continue;
      write(lines.finish());
      lines = {};
    }
    write(lines.finish());
  }

  void write(std::string_view text) {
    auto left = std::as_bytes(std::span(text));
    while (!left.empty()) {
      const std::int64_t got = file_->write(left, size_);
      if (got <= 0) throwDiskError(got < 0 ? static_cast<int>(-got) : ENOSPC, "writing", path_);
      size_ += got;
      left = left.subspan(static_cast<std::size_t>(got));
    }
  }

  std::int64_t finish() {
    checkDisk(file_->sync(), "syncing", path_);
    return size_;
  }

 private:
  std::filesystem::path path_;
  Database& database_;
  std::unique_ptr<File> file_;
  std::int64_t size_ = 0;
};

}  // namespace

std::int64_t rewriteJournal(FileOps& files, const std::filesystem::path& archive,
                            Database& database, const std::string& name, std::string_view tail) {
  const auto temporary = archive / "tmp" / (name + ".jsonl");
  Rewriter rewriter(files, temporary, database);
  if (name == kSharedJournal) {
    rewriter.table<DeviceRow>("true", {});
    rewriter.table<SpecimenRow>("true", {});
    rewriter.table<RigRecord>("true", {});
    rewriter.table<CalibrationRow>("true", {});
    rewriter.table<FrameCalibrationRow>("true", {});
    rewriter.table<ProductRow>("true", {});
    rewriter.table<ProductInputRecord>("true", {});
    rewriter.table<EventRow>("run_id IS NULL", {});
  } else {
    rewriter.table<RunRecord>("id = ?", name);
    rewriter.table<StepRow>("run_id = ?", name);
    rewriter.table<ShotRow>("step_id IN (SELECT id FROM step WHERE run_id = ?)", name);
    rewriter.table<FrameRecord>("run_id = ?", name);
    rewriter.table<ReadingRow>("run_id = ?", name);
    rewriter.table<LightCheckRow>("run_id = ?", name);
    rewriter.table<EventRow>("run_id = ?", name);
  }
  rewriter.write(tail);
  const std::int64_t size = rewriter.finish();
  const auto path = journalPath(archive, name);
  checkDisk(files.renameReplace(temporary, path), "renaming to", path);
  checkDisk(files.syncFolder(path.parent_path()), "syncing", path.parent_path());
  return size;
}

}  // namespace patina::db
