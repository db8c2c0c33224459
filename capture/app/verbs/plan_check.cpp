// SPDX-License-Identifier: GPL-3.0-or-later
// patina plan check PLAN: what the plan costs and what will not work, before anything runs.
#include "capture/app/context.h"
#include "capture/app/rig/make_devices.h"
#include "capture/app/verbs/verbs.h"
#include "capture/forecast.h"

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

// What devices can do is known before they are attached: from the rig file, or from the twin.
capture::ForecastInputs inputsOf(const Context& context, const capture::Plan& plan,
                                 const devices::RigSpec& spec) {
  capture::ForecastInputs inputs;
  inputs.begin = context.clock.utc();
  inputs.free_bytes = freeBytes(context.options.archive);
  devices::VirtualClock clock(inputs.begin);
  rig::World world;
  world.duration = plan.duration;
  world.start_utc = inputs.begin;
  const devices::Rig rig = rig::makeDevices(spec, world, clock);
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
      .set("readings", forecast.readings)
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
