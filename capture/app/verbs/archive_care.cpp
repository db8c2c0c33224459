// SPDX-License-Identifier: GPL-3.0-or-later
// patina archive verify | rebuild: is everything there, and the catalogue again from what is.
#include "capture/app/context.h"
#include "capture/app/verbs/archive_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "db/archive.h"

namespace patina::app {
namespace {

// Counts come first, then a row for each problem: exit 65 when there is one.
void verify(Context& context) {
  const db::VerifyReport report = db::verify(context.archive(), context.progress);
  const std::string sum = std::to_string(report.frames) + " frames, " +
                          formatBytes(static_cast<std::uint64_t>(report.bytes)) + ", " +
                          std::to_string(report.rows) + " rows: ";
  if (report.problems.empty()) {
    context.out.say(sum + "every hash and every row is right.");
  } else {
    context.out.say(sum + std::to_string(report.problems.size()) + " problems.");
    context.exit_code = static_cast<int>(Exit::kBadData);
  }
  if (context.options.json || !report.problems.empty()) {
    Item counts;
    counts.set("what", report.problems.empty() ? "clean" : "damaged")
        .set("path", context.archive().c_str())
        .set("detail", sum.substr(0, sum.size() - 2).c_str())
        .hidden("frames", Value{report.frames})
        .hidden("bytes", Value{report.bytes})
        .hidden("rows", Value{report.rows})
        .hidden("problems", Value{static_cast<std::int64_t>(report.problems.size())});
    context.out.add(std::move(counts));
  }
  for (const db::VerifyProblem& problem : report.problems)
    context.out.add(std::move(Item()
                                  .set("what", problem.what.c_str())
                                  .set("path", problem.path.c_str())
                                  .set("detail", problem.detail.c_str())));
}

void rebuild(Context& context, bool frames_only) {
  const db::RecoveryReport report = frames_only
                                        ? db::rebuildFromFrames(context.archive(), context.progress)
                                        : db::rebuild(context.archive(), context.progress);
  context.out.asList();
  if (frames_only) context.out.say("The old catalogue and journals lie in care/before-rebuild-N/.");
  if (report.frames_from_files > 0)
    context.out.say(std::to_string(report.frames_from_files) +
                    " frames had no row in any journal: they are run " + report.recovered_run +
                    " now. Known of them: bytes, size, camera and exposure where the picture says "
                    "so, and time (" +
                    std::to_string(report.frames_dated_by_file) +
                    " by their file's date alone). Lost: run, step, light, verdicts, readings.");
  context.out.add(std::move(Item()
                                .set("rows_from_journal", report.rows_from_journal)
                                .set("frames_from_files", report.frames_from_files)
                                .set("frames_dated_by_file", report.frames_dated_by_file)
                                .set("products_from_files", report.products_from_files)
                                .set("frames_adopted", report.frames_adopted)
                                .set("frames_missing", report.frames_missing)
                                .set("frames_quarantined", report.frames_quarantined)
                                .set("shots_lost", report.shots_lost)
                                .set("tmp_swept", report.tmp_swept)));
}

}  // namespace

void addArchiveCare(Verb archive) {
  archive.verb("verify", "Checks every hash and every row", "patina archive verify --archive ivy",
               [](Context& context) { verify(context); });
  auto frames_only = std::make_shared<bool>(false);
  archive
      .verb("rebuild", "Makes the catalogue again from journal and frames",
            "patina archive rebuild --archive ivy",
            [frames_only](Context& context) { rebuild(context, *frames_only); })
      .flag("--frames-only", *frames_only,
            "Set catalogue and journals aside and keep what the pictures themselves tell");
}

void addArchiveVerbs(Verb root) {
  Verb archive = root.group("archive", "What is in an archive, and whether all of it is well");
  addArchiveReading(archive);
  addArchiveCare(archive);
  addArchiveKeeping(archive);
  addArchiveExport(archive);
  addArchiveReport(archive);
}

}  // namespace patina::app
