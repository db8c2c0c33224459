// SPDX-License-Identifier: GPL-3.0-or-later
// A rehearsal in which the power fails: `patina rehearse` becomes the supervisor of a child that
// rehearses. At each power_cut of the faults file the child dies in the middle of a commit; what it
// had not synced is taken back; then it is started again and has to go on by itself.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "capture/app/context.h"
#include "db/archive.h"
#include "devices/fault_plan.h"

namespace patina::app {

std::vector<devices::Fault> powerCuts(const devices::FaultPlan& faults);  // in order of time

// In the child: dies by SIGKILL at the first commit at or after `cut`, at a point in the middle of
// it that the seed chooses.
std::function<void(db::CommitPoint)> dieAt(std::uint64_t seed, std::size_t cut_number,
                                           std::function<bool()> is_time);

// In the supervisor: runs children until one ends by itself, and takes over its exit code.
void superviseRehearsal(Context& context, const std::vector<devices::Fault>& cuts,
                        std::uint64_t seed);

}  // namespace patina::app
