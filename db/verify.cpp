// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "db/errors.h"
#include "db/frame_store.h"
#include "db/recovery.h"
#include "db/replica.h"
#include "db/row_statements.h"
#include "db/schema.h"

namespace patina::db {
namespace {

class Verifier {
 public:
  Verifier(const std::filesystem::path& archive, Progress& progress)
      : archive_(std::filesystem::absolute(archive).lexically_normal()), progress_(progress) {
    const auto file = archive_ / "catalog.sqlite";
    std::error_code error;
    if (!std::filesystem::exists(file, error))
      throw ArchiveError(Exit::kBadData,
                         archive.string() + " is no archive: it has no catalog.sqlite");
    catalogue_ = openForReading(file);
    checkVersion(*catalogue_);
  }

  VerifyReport run() {
    checkTables();
    checkJournals();
    checkFrames();
    checkOrphans();
    std::ranges::sort(report_.problems, {},
                      [](const VerifyProblem& p) { return std::tie(p.what, p.path, p.detail); });
    return std::move(report_);
  }

 private:
  void add(const char* what, const std::string& path, const std::string& detail) {
    const std::scoped_lock guard(mutex_);
    report_.problems.push_back({what, path, detail});
  }

  void checkTables() {
    Statement integrity(*catalogue_, "PRAGMA integrity_check");
    while (integrity.step())
      if (integrity.text(0) != "ok") add("row", "catalog.sqlite", std::string(integrity.text(0)));
    Statement keys(*catalogue_, "PRAGMA foreign_key_check");
    while (keys.step())
      add("row", "catalog.sqlite",
          "row " + std::to_string(keys.integer(1)) + " of " + std::string(keys.text(0)) +
              " refers to a row of " + std::string(keys.text(2)) + " that is not there");
  }

  // What the journals say up to where the catalogue claims to contain them, against the catalogue.
  void checkJournals() {
    Replica replica(archive_);
    progress_.begin("journals", replica.journals());
    std::map<std::string, int> count;
    const auto report = [&](const Replica::Difference& d) {
      constexpr int kShown = 20;
      if (++count[d.table] > kShown) return;
      if (d.table == "journal")
        add("journal", d.key, d.detail);
      else
        add("row", d.table + " " + d.key, d.detail);
    };
    replica.replayAll(report, [this] { progress_.step(); });
    replica.compare(report);
    report_.rows = replica.rows();
  }

  void checkFrames() {
    std::vector<FrameRow> block;
    constexpr std::size_t kTogether = 1024;
    progress_.begin("frames", catalogue_->number("SELECT count(*) FROM frame"));
    Statement statement(*catalogue_,
                        "SELECT " + columnList<FrameRecord>() + " FROM frame ORDER BY id");
    while (statement.step()) {
      block.push_back(readRow<FrameRecord>(statement).row);
      if (block.size() == kTogether) checkBlock(block);
    }
    checkBlock(block);
  }

  void checkBlock(std::vector<FrameRow>& block) {
    tbb::parallel_for(std::size_t{0}, block.size(), [&](std::size_t i) { checkFrame(block[i]); });
    for (const FrameRow& frame : block) report_.bytes += frame.bytes;
    report_.frames += static_cast<std::int64_t>(block.size());
    progress_.step(static_cast<std::int64_t>(block.size()));
    block.clear();
  }

  void checkFrame(const FrameRow& frame) {
    const auto path = archive_ / framePath(frame.sha256, frame.ext);
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) return add("missing", path.string(), "frame " + std::to_string(frame.id));
    if (static_cast<std::int64_t>(size) != frame.bytes)
      return add("size", path.string(),
                 std::to_string(size) + " bytes instead of " + std::to_string(frame.bytes));
    try {
      if (sha256OfFile(path) != frame.sha256) add("hash", path.string(), "is not what it was");
    } catch (const ProcessingError& e) {
      add("hash", path.string(), e.what());
    }
  }

  void checkOrphans() {
    // After the frames, in a moment of its own: a capturing process may have gone on meanwhile.
    std::vector<std::filesystem::path> strangers = strangeFiles();
    if (strangers.empty()) return;
    const auto still = strangeFiles();
    for (const auto& path : strangers)
      if (std::ranges::find(still, path) != still.end())
        add("orphan", path.string(), "no row names it; 'patina archive rebuild' sets it aside");
  }

  std::vector<std::filesystem::path> strangeFiles() {
    std::vector<std::filesystem::path> strangers;
    Statement known(*catalogue_, "SELECT 1 FROM frame WHERE sha256 = ? AND ext = ?");
    std::error_code error;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(archive_ / "frames", error)) {
      if (entry.is_directory(error)) continue;
      const auto name = parseFramePath(entry.path());
      const Reading reading(known);
      if (name) known.bind(1, name->sha256.hex()).bind(2, name->ext);
      if (!name || !known.step()) strangers.push_back(entry.path());
    }
    std::ranges::sort(strangers);
    return strangers;
  }

  std::filesystem::path archive_;
  Progress& progress_;
  std::shared_ptr<Database> catalogue_;
  std::mutex mutex_;
  VerifyReport report_;
};

}  // namespace

VerifyReport verify(const std::filesystem::path& archive, Progress& progress) {
  return Verifier(archive, progress).run();
}

}  // namespace patina::db
