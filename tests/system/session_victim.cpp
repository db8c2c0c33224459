// SPDX-License-Identifier: GPL-3.0-or-later
// A victim of the kill driver: a real session on the twin, in virtual time, or in real time at the
// shortest interval there is.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

#include "capture/session.h"
#include "devices/twin/twin.h"
#include "tests/system/victim.h"

namespace {

using namespace patina;

UtcTime lastRowOf(const db::ArchiveReader& reader, const db::RunRow& run) {
  UtcTime last = run.t0_utc;
  for (const db::StepRow& step : reader.steps(run.id)) last = std::max(last, step.due_utc);
  return last;
}

std::unique_ptr<devices::Clock> clockOf(const std::string& name, const db::ArchiveReader& reader) {
  if (name == "real") return std::make_unique<devices::RealClock>();
  const auto runs = reader.runs();
  if (runs.empty())
    return std::make_unique<devices::VirtualClock>(parseUtc("2024-05-01T12:00:00Z"));
  const db::RunRow& run = runs.back();
  const UtcTime now = lastRowOf(reader, run);
  return std::make_unique<devices::VirtualClock>(now, run.t0_boot + (now - run.t0_utc),
                                                 run.boot_id);
}

void run(const testing::VictimArguments& arguments) {
  devices::RigSpec rig_spec = devices::parseRig(testing::victimRig(), "rig.toml");
  for (const auto& camera : rig_spec.cameras)
    rig_spec.patches.push_back(
        {camera.id, devices::twin::pictureLayout(rig_spec, camera).patch_px});
  const capture::Plan plan =
      capture::parsePlan(testing::victimPlan(arguments.duration), "plan.toml");
  db::ArchiveOptions options;
  options.folder = arguments.archive;
  options.owner = "session victim";
  options.at_point = testing::dieAtPoint(arguments);
  options.mutant = arguments.mutant;
  db::Archive archive(options);
  const auto clock = clockOf(arguments.clock, archive.reader());
  const capture::RunStart start = capture::startRun(plan, rig_spec, archive, *clock, {});
  devices::twin::TwinOptions twin;
  twin.duration = plan.duration;
  twin.start_utc = start.t0_utc;
  devices::Rig rig = devices::twin::makeTwinRig(rig_spec, twin, *clock);
  capture::SessionHooks hooks;
  hooks.on_acknowledged = [&](const db::FrameRow& frame) {
    testing::tellAck(arguments.acks, start.run_id, frame.shot_id, frame.file_index,
                     frame.sha256.hex(), frame.bytes);
  };
  capture::runSession(plan, rig, archive, *clock, start, hooks);
}

}  // namespace

int main(int argc, char** argv) {
  const testing::VictimArguments arguments = testing::parseVictimArguments(argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 74;
  }
  return 0;
}
