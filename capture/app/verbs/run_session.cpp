// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/run_session.h"

#include <csignal>

#include "capture/app/daemon/ack_log.h"
#include "capture/app/daemon/after_work.h"
#include "capture/app/verbs/specimen_place.h"
#include "db/power_cut.h"

namespace patina::app {
namespace {

std::string statusLine(const capture::SessionStatus& status) {
  std::string line = "step " + std::to_string(status.step) + "/" + std::to_string(status.steps) +
                     "  next " + formatUtc(status.next_due_utc).substr(0, 19) + "  captured " +
                     std::to_string(status.captured);
  const auto unless_none = [&line](const char* name, std::int64_t count) {
    if (count > 0) line += std::string("  ") + name + " " + std::to_string(count);
  };
  unless_none("held", status.held);
  unless_none("missed", status.missed);
  unless_none("skipped", status.skipped);
  unless_none("failed", status.failed);
  if (!status.light.empty()) line += "  light " + status.light;
  if (status.disk_free_bytes > 0) line += "  disk " + formatBytes(status.disk_free_bytes);
  if (status.disk_full_utc) line += " full about " + formatUtc(*status.disk_full_utc).substr(0, 16);
  if (!status.note.empty()) line += "  " + status.note;
  return line;
}

std::string alertLine(const capture::AlertNews& news) {
  return formatUtc(news.utc) + "  " + name(news.severity) + ": " +
         describe(news.kind, news.subject) + " " + name(news.event) + ": " + news.detail;
}

Item summaryItem(const capture::SessionSummary& summary, const capture::RunStart& start) {
  const capture::SessionStatus& last = summary.last;
  return std::move(Item()
                       .set("run_id", start.run_id.c_str())
                       .set("end", summary.end.c_str())
                       .set("t0_utc_ns", start.t0_utc)
                       .hidden("resumed", start.resumed)
                       .set("steps", last.steps)
                       .set("captured", last.captured)
                       .set("held", last.held)
                       .set("skipped", last.skipped)
                       .set("missed", last.missed)
                       .set("failed", last.failed)
                       .set("partial", last.partial)
                       .set("event_log_sha256", summary.event_log_sha256.c_str()));
}

// What can be made of a run that goes on: in virtual time between its steps, else in a process of
// its own, which ends with the session.
std::unique_ptr<daemon::AfterWork> feedAsStepsArrive(Context& context, const RunFiles& files,
                                                     const devices::Clock& clock,
                                                     const capture::RunStart& start,
                                                     capture::SessionHooks& hooks) {
  if (!capture::isFedBySteps(files.plan)) return nullptr;
  std::unique_ptr<daemon::AfterWork> work;
  std::function<void()> feed = [&context, &files, run_id = start.run_id] {
    workflow::feedRun(context.archive(), run_id, afterOptions(files), context.progress);
  };
  if (clock.threadSafe()) {
    work = std::make_unique<daemon::AfterWork>(
        std::vector<std::string>{std::filesystem::read_symlink("/proc/self/exe").string(), "run",
                                 "after", "--archive",
                                 std::filesystem::absolute(context.archive()).string(), "--quiet",
                                 "--with-parent", "--so-far"},
        [](const std::string&, const std::string&) {});  // what fails is told when the run ends
    feed = [&feeder = *work, run_id = start.run_id] { feeder.add(run_id); };
  }
  hooks.on_step = [feed, before = hooks.on_step](const db::StepRow& step) {
    if (before) before(step);
    if (step.decision == db::Decision::kCaptured) feed();
  };
  return work;
}

}  // namespace

void addRunOptions(Verb& verb, const std::shared_ptr<RunOptions>& options) {
  verb.required("PLAN", options->plan, "The plan's .toml file")
      .flag("--new-run", options->new_run, "Leave an unfinished run as it is and begin another")
      .option("--log-acks", options->log_acks, "FILE", "A line for each acknowledged frame")
      .option("--power-cut-log", options->power_cut_log, "DIR", "What a power cut would undo")
      .conceal("--log-acks")
      .conceal("--power-cut-log");
}

RunFiles readRunFiles(const Context& context, const std::string& plan) {
  return daemon::readRunFiles(plan, context.options.seed);
}

OwnedArchive::OwnedArchive(const Context& context, const RunOptions& options,
                           std::function<void(db::CommitPoint)> at_point) {
  db::ArchiveOptions opening;
  opening.folder = context.archive();
  opening.owner = context.command;
  opening.at_point = std::move(at_point);
  if (!options.power_cut_log.empty()) {
    files_ = std::make_unique<db::PowerCutFiles>(db::realFileOps(), options.power_cut_log);
    opening.files = files_.get();
  }
  archive_ = std::make_unique<db::Archive>(opening);
}

OwnedArchive::~OwnedArchive() = default;

void runToEnd(Context& context, const RunOptions& options, const RunFiles& files,
              OwnedArchive& archive, devices::Clock& clock, const capture::RunStart& start,
              capture::notify::RunNotices* notices) {
  const daemon::AckLog acks(options.log_acks);
  std::stop_source stop;
  capture::SessionHooks hooks;
  hooks.stop = stop.get_token();
  hooks.shoot_now = &context.signals.shootNow();
  hooks.on_status = [&](const capture::SessionStatus& status) {
    context.progress.status(statusLine(status));
  };
  hooks.on_acknowledged = [&](const db::FrameRow& frame) { acks.take(start.run_id, frame); };
  int alerts = 0;
  hooks.on_alert = [&](const capture::AlertNews& news) {
    if (news.event == capture::AlertEvent::kBegins) ++alerts;
    context.verbose(alertLine(news));
  };
  if (notices) notices->hookInto(hooks);
  const std::unique_ptr<daemon::AfterWork> feeding =
      feedAsStepsArrive(context, files, clock, start, hooks);
  if (start.resumed) context.verbose("going on with " + start.run_id);
  capture::SessionSummary summary;
  try {
    devices::Rig rig = clock.threadSafe() ? daemon::openRig(files, start, clock)
                                          : daemon::openTwinOnly(files, start, clock);
    context.signals.onStop([&stop] { stop.request_stop(); });
    summary = capture::runSession(files.plan, rig, *archive, clock, start, hooks);
  } catch (const Failure& failure) {
    if (notices) notices->failed(failure);
    throw;
  }
  if (notices) notices->ended(summary);
  context.progress.clear();
  Progress& progress = context.progress;
  context.signals.onStop([&progress] { progress.askToStop(); });
  Item item = summaryItem(summary, start);
  item.set("alerts", alerts);
  if (summary.end == "finished") return finishAfter(context, files, start.run_id, std::move(item));
  context.out.asList();
  context.out.add(std::move(item));
  context.out.say("Stopped; the same command goes on at the next step.");
  if (summary.end == "disk") {
    context.exit_code = static_cast<int>(Exit::kCannotCreate);
    context.warn("the disk is full: nothing acknowledged is lost; make room and run it again");
  } else if (context.signals.received() == SIGINT) {
    context.exit_code = 128 + SIGINT;
  }
}

workflow::AfterOptions afterOptions(const RunFiles& files) {
  workflow::AfterOptions after;
  after.steps = files.plan.after;
  after.bin = files.plan.after_bin;
  after.degree = files.plan.after_degree;
  if (!files.plan.after_register.empty()) {
    after.registration.emplace();
    after.registration->model = calibration::parseMotionModel(files.plan.after_register);
    if (const auto& fiducial = files.plan.after_fiducial)
      after.registration->fiducials = {*fiducial};
  }
  after.version = PATINA_VERSION;
  after.seed = files.plan.seed;
  if (files.rig.twin) after.process = files.rig.twin->specimen;
  after.place = [&files](const std::string& camera) { return placeOfSpecimen(files.rig, camera); };
  after.lamps = lampsOf(files.rig);
  return after;
}

void finishAfter(Context& context, const RunFiles& files, const std::string& run_id, Item item) {
  const auto products = workflow::finishRun(
      context.archive(), run_id, afterOptions(files), [&context] { return context.clock.utc(); },
      context.progress);
  std::vector<std::string> paths;
  for (const workflow::AfterProduct& product : products) {
    paths.push_back(product.path.string());
    for (const std::string& warning : product.warnings) context.warn(warning);
  }
  if (!paths.empty()) item.set("products", Value{paths});
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace patina::app
