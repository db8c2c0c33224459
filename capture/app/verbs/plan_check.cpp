// SPDX-License-Identifier: GPL-3.0-or-later
// patina plan check PLAN: what the plan costs and what will not work, before anything runs.
#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/plan.h"

namespace patina::app {
namespace {

void check(Context& context, const std::string& file) {
  const capture::Plan plan = capture::readPlan(file);
  const devices::RigSpec rig = devices::readRig(plan.rig_file);
  capture::checkAgainst(plan, rig);
  context.out.asList();
  context.out.add(Item()
                      .set("plan", file)
                      .set("rig", rig.name)
                      .set("specimen", plan.specimen)
                      .set("interval_ns", plan.interval)
                      .set("duration_ns", plan.duration)
                      .set("steps", capture::stepCount(plan))
                      .set("shots_a_step", capture::shotsAStep(plan)));
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
