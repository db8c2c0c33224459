// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/simulation.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "capture/windows.h"
#include "devices/fault/faulty_devices.h"
#include "devices/twin/twin.h"

namespace patina::testing {
namespace {

std::string rigText(const SimulationOptions& o) {
  std::string text = "name = \"bench\"\n";
  std::string patches;
  for (int i = 0; i < o.cameras; ++i) {
    const std::string id = "cam" + std::to_string(i);
    text += "[[camera]]\nid = \"" + id + "\"\nbackend = \"twin\"\nsettings = { format = \"" +
            o.format + "\" }\n";
  }
  for (const char* id : {"key", "fill"})
    text += std::string("[[light]]\nid = \"") + id + "\"\nbackend = \"twin\"\nbetween = \"" +
            o.between + "\"\n";
  text += "[twin]\nspecimen = \"" + o.specimen + "\"\nsize = \"" + o.size + "\"\n";
  return text + o.rig;
}

std::string planText(const SimulationOptions& o) {
  return "rig = \"rig.toml\"\nspecimen = \"card\"\nseed = " + std::to_string(o.seed) +
         "\ninterval = \"" + o.interval + "\"\nduration = \"" + o.duration + "\"\n" + o.plan +
         "\n[[sweep]]\nlights = " + o.lights + "\nexposures = " + o.exposures +
         "\n[light_check]\n" + o.light_check + "\n";
}

}  // namespace

Simulation::Simulation(const SimulationOptions& o)
    : options(o), clock(parseUtc("2024-05-01T12:00:00Z")) {
  rig_spec = devices::parseRig(rigText(o), folder_ / "rig.toml");
  // The patch is where the twin draws it.
  for (const auto& camera : rig_spec.cameras)
    rig_spec.patches.push_back(
        {camera.id, devices::twin::pictureLayout(rig_spec, camera).patch_px});
  plan = capture::parsePlan(planText(o), folder_ / "plan.toml");
  archive_options.folder = folder_ / "archive";
  archive_options.owner = "simulation";
}

capture::SessionSummary Simulation::run(
    const std::function<void(capture::SessionHooks&)>& prepare) {
  reader_.reset();
  db::Archive archive(archive_options);
  const auto start = capture::startRun(plan, rig_spec, archive, clock, session_options);
  run_id = start.run_id;
  t0 = start.t0_utc;
  devices::FaultPlan faults = devices::parseFaults(options.faults, folder_ / "faults.toml");
  faults.seed = options.seed;
  devices::twin::TwinOptions twin;
  twin.seed = options.seed;
  twin.duration = plan.duration;
  twin.start_utc = start.t0_utc;
  twin.faults = faults;
  devices::Rig rig = devices::twin::makeTwinRig(rig_spec, twin, clock);
  const MonoTime begin = clock.mono() - (clock.utc() - start.t0_utc);
  for (auto& camera : rig.cameras)
    camera = devices::withFaults(std::move(camera), faults, begin, clock);
  for (auto& sensor : rig.sensors)
    sensor = devices::withFaults(std::move(sensor), faults, begin, clock);
  capture::SessionHooks hooks;
  if (prepare) prepare(hooks);
  return capture::runSession(plan, rig, archive, clock, start, hooks);
}

const db::ArchiveReader& Simulation::reader() {
  if (!reader_) reader_ = std::make_unique<db::ArchiveReader>(archive_options.folder);
  return *reader_;
}

std::vector<std::string> Simulation::decisions() {
  std::map<std::int64_t, std::string> by_number;
  for (const auto& step : reader().steps(run_id))
    if (step.number) by_number[*step.number] = db::name(step.decision);
  std::vector<std::string> out;
  for (const auto& [number, decision] : by_number) out.push_back(decision);
  return out;
}

std::vector<db::EventRow> Simulation::events(const std::string& kind) {
  std::vector<db::EventRow> out;
  for (const auto& event : reader().events(run_id))
    if (event.kind == kind) out.push_back(event);
  return out;
}

void Simulation::expectWhole() {
  std::map<std::int64_t, int> rows;
  for (const auto& step : reader().steps(run_id)) {
    if (step.number) ++rows[*step.number];
    EXPECT_NE(step.decision, db::Decision::kPending) << step.number.value_or(-1);
    int captured = 0;
    std::set<std::string> slots;
    for (const auto& shot : reader().shotsOfStep(step.id)) {
      EXPECT_NE(shot.state, db::ShotState::kArmed);
      if (shot.state != db::ShotState::kCaptured) continue;
      ++captured;
      EXPECT_TRUE(slots
                      .insert(shot.device_id + " " + shot.light_state + " " +
                              std::to_string(shot.exposure_index))
                      .second)
          << "doubled in step " << step.number.value_or(-1);
    }
    EXPECT_EQ(captured, step.shots_captured) << step.number.value_or(-1);
    EXPECT_EQ(step.decision == db::Decision::kCaptured, captured == step.shots_due);
    EXPECT_EQ(reader().framesOfStep(step.id).size() % std::max(1, captured), 0u);
  }
  for (std::int64_t k = 0; k < capture::slotCount(plan); ++k) EXPECT_EQ(rows[k], 1) << "step " << k;
  Progress progress;
  const db::VerifyReport report = db::verify(archive_options.folder, progress);
  for (const auto& p : report.problems) ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
}

}  // namespace patina::testing
