// SPDX-License-Identifier: GPL-3.0-or-later
// Which run a plan belongs to: a new one, or the unfinished one that goes on.
#include <algorithm>

#include "capture/scheduler.h"
#include "capture/session.h"

namespace patina::capture {
namespace {

std::string freeRunId(const db::ArchiveReader& reader, UtcTime t0, const std::string& specimen) {
  const std::string base = formatUtcCompact(t0) + "-" + specimen;
  const auto runs = reader.runs();
  std::string id = base;
  for (int n = 2; std::any_of(runs.begin(), runs.end(), [&](const auto& r) { return r.id == id; });
       ++n)
    id = base + "-" + std::to_string(n);
  return id;
}

void addDevices(const devices::RigSpec& rig, db::Archive& archive) {
  for (const auto& d : rig.cameras) archive.addDevice({d.id, "camera", d.backend, d.serial, ""});
  for (const auto& d : rig.lights) archive.addDevice({d.id, "light", d.backend, "", d.address});
  for (const auto& d : rig.sensors)
    archive.addDevice({d.id, "sensor", d.backend, "", devices::name(d.quantity)});
  for (const auto& d : rig.triggers) archive.addDevice({d.id, "trigger", d.backend, "", d.address});
}

void abortForNew(const db::RunRow& run, db::Archive& archive, const devices::Clock& clock) {
  db::EventRow event;
  event.run_id = run.id;
  event.utc = clock.utc();
  event.kind = "aborted";
  event.detail = "a new run was asked for";
  archive.addEvent(event);
  archive.setRunState(run.id, "aborted");
}

}  // namespace

bool isUnfinished(const db::RunRow& run) {
  return run.state == "running" || run.state == "paused" || run.state == "stopped";
}

RunStart startRun(const Plan& plan, const devices::RigSpec& rig, db::Archive& archive,
                  devices::Clock& clock, const SessionOptions& options) {
  checkAgainst(plan, rig);
  auto unfinished = archive.reader().runs();
  std::erase_if(unfinished, [&](const db::RunRow& run) {
    return !isUnfinished(run) || run.specimen != plan.specimen;
  });
  if (!unfinished.empty() && !options.new_run) {
    const db::RunRow& run = unfinished.back();
    if (run.plan_sha256 == plan.sha256) return {run.id, run.t0_utc, true};
    throw CaptureError(Exit::kTemporary,
                       "run " + run.id + " is unfinished and was started with another plan than " +
                           plan.source.string() +
                           " is now: a run never changes its plan. Go on with the plan as it was "
                           "(`patina archive show " +
                           run.id + "` prints it), or start a new run with --new-run");
  }
  if (options.before_new) options.before_new();
  for (auto run = unfinished.rbegin(); run != unfinished.rend(); ++run)
    abortForNew(*run, archive, clock);
  RunStart start;
  start.t0_utc = options.t0_utc.value_or(
      plan.start_utc && *plan.start_utc > clock.utc() ? *plan.start_utc : clock.utc());
  start.run_id = freeRunId(archive.reader(), start.t0_utc, plan.specimen);
  const ScheduleState schedule =
      beginSchedule(start.t0_utc, {clock.utc(), clock.mono(), clock.bootId()});
  db::RunRow run;
  run.id = start.run_id;
  run.specimen = plan.specimen;
  run.plan_toml = plan.toml;
  run.plan_sha256 = plan.sha256;
  run.rig_toml = rig.toml;
  run.rig = rig.name;
  run.boot_id = clock.bootId();
  run.t0_utc = start.t0_utc;
  run.t0_boot = schedule.anchor.mono;
  run.seed = plan.seed;
  run.state = "running";
  run.interval = plan.interval;
  run.duration = plan.duration;
  db::SpecimenRow specimen;
  specimen.name = plan.specimen;
  archive.beginRun(run, specimen);
  addDevices(rig, archive);
  // Where its rig and its faults are looked for when it goes on without being asked for by name.
  db::EventRow source;
  source.run_id = run.id;
  source.utc = clock.utc();
  source.kind = "plan";
  source.detail = std::filesystem::absolute(plan.source).lexically_normal().string();
  archive.addEvent(source);
  return start;
}

}  // namespace patina::capture
