// SPDX-License-Identifier: GPL-3.0-or-later
// patina plan check PLAN: what the plan costs and what will not work, before anything runs.
#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/forecast.h"
#include "devices/twin/twin.h"

namespace patina::app {
namespace {

// Where the archive will lie, or as much of the path as is there.
std::optional<std::uint64_t> freeBytes(const std::filesystem::path& archive) {
  if (archive.empty()) return std::nullopt;
  std::filesystem::path there = std::filesystem::absolute(archive);
  std::error_code failed;
  while (!std::filesystem::exists(there, failed) && there.has_relative_path())
    there = there.parent_path();
  const auto space = std::filesystem::space(there, failed);
  return failed ? std::nullopt : std::optional<std::uint64_t>(space.available);
}

bool isTwin(const devices::RigSpec& rig) {
  const auto twin = [](const auto& device) { return device.backend == "twin"; };
  return std::all_of(rig.cameras.begin(), rig.cameras.end(), twin) &&
         std::all_of(rig.lights.begin(), rig.lights.end(), twin) &&
         std::all_of(rig.sensors.begin(), rig.sensors.end(), twin);
}

// A simulated rig can be asked what it can do; devices that are not attached cannot.
capture::ForecastInputs inputsOf(const Context& context, const capture::Plan& plan,
                                 const devices::RigSpec& spec) {
  capture::ForecastInputs inputs;
  inputs.begin = context.clock.utc();
  inputs.free_bytes = freeBytes(context.options.archive);
  if (!isTwin(spec)) return inputs;
  devices::VirtualClock clock(inputs.begin);
  devices::twin::TwinOptions options;
  options.duration = plan.duration;
  options.start_utc = inputs.begin;
  const devices::Rig rig = devices::twin::makeTwinRig(spec, options, clock);
  for (const auto& camera : rig.cameras) inputs.cameras.push_back(camera->caps());
  for (const auto& light : rig.lights) inputs.lights.push_back(light->caps());
  return inputs;
}

void check(Context& context, const std::string& file) {
  const capture::Plan plan = capture::readPlan(file);
  const devices::RigSpec rig = devices::readRig(plan.rig_file);
  capture::checkAgainst(plan, rig);
  const capture::Forecast forecast = capture::forecast(plan, rig, inputsOf(context, plan, rig));
  Item item;
  item.set("plan", file.c_str())
      .set("rig", rig.name.c_str())
      .set("specimen", plan.specimen.c_str())
      .set("interval_ns", plan.interval)
      .set("duration_ns", plan.duration)
      .set("begin_utc_ns", forecast.begin)
      .set("end_utc_ns", forecast.end)
      .set("steps", forecast.steps)
      .set("shots", forecast.shots)
      .set("sweep_ns", forecast.sweep)
      .bytes("frame_bytes", static_cast<std::uint64_t>(forecast.frame_bytes))
      .bytes("catalogue_bytes", static_cast<std::uint64_t>(forecast.catalogue_bytes));
  if (forecast.disk_full) item.set("disk_full_utc_ns", *forecast.disk_full);
  for (const auto& [light, hours] : forecast.lamp_hours)
    item.set("lamp_hours_" + light, Value{hours});
  for (const auto& [camera, count] : forecast.actuations) item.set("actuations_" + camera, count);
  std::string lines;
  for (const std::string& warning : forecast.warnings) lines += "\n  " + warning;
  item.set("warnings", Value{forecast.warnings}, lines.empty() ? "none" : lines);
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addPlanVerbs(Verb root) {
  Verb plan = root.group("plan", "Plans: what to shoot, when, under which light");
  auto file = std::make_shared<std::string>();
  plan.verb("check", "Steps, shots, bytes, lamp hours and conflicts, before anything runs",
            "patina plan check examples/banana/plan.toml",
            [file](Context& context) { check(context, *file); })
      .required("PLAN", *file, "The plan's .toml file");
}

}  // namespace patina::app
