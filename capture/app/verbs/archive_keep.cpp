// SPDX-License-Identifier: GPL-3.0-or-later
// patina archive backup | gc | scrub: what keeps an archive well over months. Each may run beside a
// capturing process.
#include "capture/app/context.h"
#include "capture/app/verbs/archive_verbs.h"
#include "db/care/backup.h"
#include "db/care/gc.h"
#include "db/care/scrub.h"

namespace patina::app {
namespace {

namespace care = db::care;
using namespace std::chrono_literals;

void backUp(Context& context, const std::string& to, bool check) {
  care::BackupOptions options;
  options.check = check;
  options.owner = context.command;
  const care::BackupReport report = care::backup(context.archive(), to, options, context.progress);
  context.out.asList();
  std::vector<std::string> damaged;
  for (const care::BackupProblem& p : report.problems)
    damaged.push_back(p.what + " " + p.path + ": " + p.detail);
  Item item;
  item.set("path", to.c_str())
      .set("runs", report.runs)
      .set("frames", report.frames)
      .set("frames_copied", report.frames_copied)
      .set("products_copied", report.products_copied)
      .set("set_aside_copied", report.set_aside_copied)
      .bytes("bytes_copied", report.bytes_copied)
      .set("problems", static_cast<std::int64_t>(damaged.size()));
  if (!damaged.empty()) {
    std::string lines;
    for (const std::string& line : damaged) lines += "\n  " + line;
    item.set("damaged", Value{damaged}, lines);
    context.exit_code = static_cast<int>(Exit::kBadData);
  }
  context.out.add(std::move(item));
}

void sweep(Context& context, Nanoseconds grace, bool dry_run) {
  constexpr Nanoseconds kGraceLeast = 1h;
  if (grace < kGraceLeast)
    throw AppError(Exit::kUsage, "--grace " + formatDuration(grace) +
                                     " is too short (1h or more): a product has no row while it is "
                                     "being made");
  care::GcOptions options;
  options.grace = grace;
  options.dry_run = dry_run;
  options.now = context.clock.utc();
  options.owner = context.command;
  const care::GcReport report = care::gc(context.archive(), options, context.progress);
  const auto sum = [&](care::GcAction action) {
    return std::to_string(report.countOf(action)) + " (" +
           formatBytes(static_cast<std::uint64_t>(report.bytesOf(action))) + ")";
  };
  context.out.say(std::string(dry_run ? "Would free " : "Freed ") + sum(care::GcAction::kFreed) +
                  ", " + (dry_run ? "would move " : "moved ") + sum(care::GcAction::kTrashed) +
                  " to trash/; " + sum(care::GcAction::kWaiting) + " wait, " +
                  sum(care::GcAction::kMarked) + " newly marked, " +
                  sum(care::GcAction::kReturned) + " returned.");
  for (const care::GcItem& i : report.items)
    context.out.add(std::move(Item()
                                  .set("path", i.path.c_str())
                                  .set("action", care::name(i.action))
                                  .bytes("bytes", static_cast<std::uint64_t>(i.bytes))
                                  .set("since_utc_ns", i.since)
                                  .set("due_utc_ns", i.due)));
}

void scrub(Context& context, Nanoseconds max_duration) {
  care::ScrubOptions options;
  options.max_duration = max_duration;
  options.mono = [&context] { return context.clock.mono(); };
  options.utc = [&context] { return context.clock.utc(); };
  options.owner = context.command;
  const care::ScrubReport report = care::scrub(context.archive(), options, context.progress);
  std::string sum = std::to_string(report.frames) + " frames, " +
                    formatBytes(static_cast<std::uint64_t>(report.bytes)) +
                    " checked: " + std::to_string(report.problems.size()) + " damaged. ";
  if (report.unchecked > 0)
    sum += std::to_string(report.unchecked) + " frames were never checked yet.";
  else if (report.oldest_check)
    sum += "Every frame was checked since " + formatUtc(*report.oldest_check) + ".";
  context.out.say(sum);
  if (!report.remembered)
    context.warn("the archive cannot be written: the next scrub begins here again");
  if (!report.problems.empty()) context.exit_code = static_cast<int>(Exit::kBadData);
  if (context.options.json || !report.problems.empty()) {
    Item counts;
    counts.set("what", report.problems.empty() ? "clean" : "damaged")
        .set("path", context.archive().c_str())
        .set("detail", sum.c_str())
        .hidden("frames", Value{report.frames})
        .hidden("bytes", Value{report.bytes})
        .hidden("unchecked", Value{report.unchecked})
        .hidden("problems", Value{static_cast<std::int64_t>(report.problems.size())});
    context.out.add(std::move(counts));
  }
  for (const care::ScrubProblem& p : report.problems)
    context.out.add(std::move(Item()
                                  .set("what", p.what.c_str())
                                  .set("path", p.path.c_str())
                                  .set("detail", p.detail.c_str())
                                  .hidden("run_id", Value{p.run_id})
                                  .hidden("frame_id", Value{p.frame_id})));
}

}  // namespace

void addArchiveKeeping(Verb archive) {
  struct Backup {
    std::string to;
    bool check = false;
  };
  auto b = std::make_shared<Backup>();
  archive
      .verb("backup",
            "Copies what is not yet in a backup, also while a run captures; exit 65 names damage",
            "patina archive backup /media/disk/ivy --archive ivy",
            [b](Context& context) { backUp(context, b->to, b->check); })
      .required("DEST", b->to, "The backup's folder; `--archive DEST` restores from it")
      .flag("--check", b->check, "Hash what the backup holds already, and replace what is damaged");
  struct Gc {
    Nanoseconds grace = 24h * 7;
    bool dry_run = false;
  };
  auto g = std::make_shared<Gc>();
  archive
      .verb("gc", "Removes files that no row names: to trash/ after the grace, away after another",
            "patina archive gc --grace 7d --dry-run --archive ivy",
            [g](Context& context) { sweep(context, g->grace, g->dry_run); })
      .option("--grace", g->grace, parseDuration, "DURATION",
              "How long a file must stay unnamed (7d; 1h or more)")
      .flag("--dry-run", g->dry_run, "Say what would go; change nothing");
  auto limit = std::make_shared<Nanoseconds>(10min);
  archive
      .verb("scrub", "Hashes the frames whose last check is oldest; exit 65 when one is damaged",
            "patina archive scrub --max-duration 10min --archive ivy",
            [limit](Context& context) { scrub(context, *limit); })
      .option("--max-duration", *limit, parseDuration, "DURATION",
              "Stop after this time (10min); the next scrub goes on there");
}

}  // namespace patina::app
