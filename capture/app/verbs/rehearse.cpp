// SPDX-License-Identifier: GPL-3.0-or-later
// patina rehearse PLAN: the whole plan on the twin, in virtual time, by the code of a real run.
#include <algorithm>

#include "capture/app/verbs/power_cut_rehearsal.h"
#include "capture/app/verbs/run_session.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

// Rehearsals begin here unless the plan or the archive says otherwise, so that they repeat.
constexpr const char* kEpoch = "2024-05-01T12:00:00Z";

struct RehearseOptions : RunOptions {
  std::optional<UtcTime> start;
  Nanoseconds off{};   // the rig was without power for so long before it goes on
  int cuts_done = -1;  // of a supervised child: power cuts it has been through
};

// The newest run of this very plan; whatever its state.
std::optional<db::RunRow> runOfPlan(const db::ArchiveReader& reader, const capture::Plan& plan) {
  std::optional<db::RunRow> newest;
  for (const db::RunRow& run : reader.runs())
    if (run.plan_sha256 == plan.sha256 && run.state != "aborted") newest = run;
  return newest;
}

UtcTime lastRowOf(const db::ArchiveReader& reader, const db::RunRow& run) {
  UtcTime last = run.t0_utc;
  for (const db::StepRow& step : reader.steps(run.id)) last = std::max(last, step.due_utc);
  if (const auto frame = reader.newestFrame(run.id)) last = std::max(last, frame->utc);
  return last;
}

// A new rehearsal comes after every run there is: time does not run backwards in an archive.
UtcTime freshStart(const db::ArchiveReader& reader, const RunFiles& files,
                   const RehearseOptions& options) {
  if (options.start) return *options.start;
  if (files.plan.start_utc) return *files.plan.start_utc;
  UtcTime start = parseUtc(kEpoch);
  for (const db::RunRow& run : reader.runs())
    while (run.t0_utc + run.duration > start) start += std::chrono::hours(24);
  return start;
}

// Within one boot utc and mono keep step; after a time without power the machine has booted anew.
devices::VirtualClock clockOf(const std::optional<db::RunRow>& resumed, UtcTime now,
                              const RehearseOptions& options) {
  if (!resumed) return devices::VirtualClock(now);
  if (options.off == Nanoseconds{})
    return devices::VirtualClock(now, resumed->t0_boot + (now - resumed->t0_utc), resumed->boot_id);
  return devices::VirtualClock(now + options.off, monoFromNs(60'000'000'000),
                               "virtual-boot-" + formatUtcCompact(now + options.off));
}

void rehearse(Context& context, const RehearseOptions& options) {
  const RunFiles files = readRunFiles(context, options.plan);
  const std::vector<devices::Fault> cuts = powerCuts(files.faults);
  if (!cuts.empty() && options.cuts_done < 0)
    return superviseRehearsal(context, cuts, files.faults.seed);

  std::optional<devices::VirtualClock> clock;
  UtcTime t0;
  std::function<void(db::CommitPoint)> at_point;
  if (const auto done = static_cast<std::size_t>(std::max(options.cuts_done, 0));
      done < cuts.size())
    at_point = dieAt(files.faults.seed, done,
                     [&, at = cuts[done].at] { return clock && clock->utc() - t0 >= at; });
  OwnedArchive archive(context, options, at_point);
  std::optional<db::RunRow> before;
  if (!options.new_run) before = runOfPlan(archive->reader(), files.plan);
  if (before && !capture::isUnfinished(*before)) {
    context.out.say("This plan has been rehearsed already; --new-run rehearses it again.");
    return finishAfter(context, files, before->id,
                       std::move(Item().set("run_id", before->id.c_str()).set("end", "finished")));
  }
  const UtcTime now = before ? lastRowOf(archive->reader(), *before)
                             : freshStart(archive->reader(), files, options);
  t0 = before ? before->t0_utc : now;
  clock.emplace(clockOf(before, now, options));
  capture::SessionOptions session{options.new_run, {}};
  if (!before) session.t0_utc = now;
  const capture::RunStart start =
      capture::startRun(files.plan, files.rig, *archive, *clock, session);
  runToEnd(context, options, files, archive, *clock, start);
}

}  // namespace

void addRehearseVerb(Verb root) {
  auto options = std::make_shared<RehearseOptions>();
  Verb verb = root.verb("rehearse", "The whole plan on the twin, in virtual time, by the same code",
                        "patina rehearse examples/banana/plan.toml --archive rehearsal",
                        [options](Context& context) { rehearse(context, *options); });
  addRunOptions(verb, options);
  verb.option("--start", options->start, parseUtc, "UTC", "When it begins (default: the plan's)")
      .option("--off", options->off, parseDuration, "TIME", "Time without power before it goes on")
      .option("--cuts-done", options->cuts_done, 0, 1000, "Power cuts it has been through")
      .conceal("--off")
      .conceal("--cuts-done");
}

}  // namespace patina::app
