// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_counts.h"

#include "capture/scheduler.h"

namespace patina::daemon {
namespace {

std::int64_t stepsOfPlan(const db::RunRow& run) {
  try {
    return capture::stepCount(capture::parsePlan(run.plan_toml, "plan.toml"), run.t0_utc);
  } catch (const Failure&) {
    return 0;  // imported, or of an older program
  }
}

capture::SessionStatus counted(const db::ArchiveReader& reader, const db::RunRow& run) {
  capture::SessionStatus status;
  status.run_id = run.id;
  for (const db::StepRow& row : reader.steps(run.id)) capture::countStep(row, status);
  status.steps = std::max(stepsOfPlan(run), status.step);
  return status;
}

}  // namespace

capture::SessionStatus RunCounts::of(const db::ArchiveReader& reader, const db::RunRow& run) {
  const bool over = run.state == "finished" || run.state == "aborted";
  if (!over) return counted(reader, run);
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = over_.find(run.id); known != over_.end()) return known->second;
  }
  const capture::SessionStatus status = counted(reader, run);
  const std::lock_guard lock(mutex_);
  return over_.emplace(run.id, status).first->second;
}

}  // namespace patina::daemon
