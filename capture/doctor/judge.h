// SPDX-License-Identifier: GPL-3.0-or-later
// What the facts mean for a run of days. Pure.
#pragma once

#include <string>
#include <vector>

#include "capture/doctor/facts.h"

namespace patina::doctor {

enum class Level { kOk, kWarn, kFail };
const char* name(Level level);  // "ok" "warn" "fail"

struct Finding {
  std::string subject;  // "disk speed" "clock" ...
  Level level = Level::kOk;
  std::string what;     // one line: what is the case
  std::string do_this;  // one line: what to do about it; empty when ok
};

std::vector<Finding> judge(const MachineFacts& machine);
std::vector<Finding> judge(const ArchiveFacts& archive);

}  // namespace patina::doctor
