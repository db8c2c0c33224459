// SPDX-License-Identifier: GPL-3.0-or-later
// One week: a drawn plan run to its end through all its troubles, under the oracle's eyes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/sim/week_plan.h"

namespace patina::testing {

struct WeekOutcome {
  std::vector<std::string> problems;  // broken invariants
  std::string log_sha256;             // of what happened, in order; no picture's bytes in it
  int lives = 0;
  std::size_t acknowledged = 0, pictures = 0;
  std::int64_t calm_steps = 0;  // in which every camera had to shoot
};

// `tamper` may change the archive before it is judged: a planted bug.
WeekOutcome runWeek(std::uint64_t seed,
                    const std::function<void(const std::filesystem::path& archive)>& tamper = {});

}  // namespace patina::testing
