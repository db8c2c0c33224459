// SPDX-License-Identifier: GPL-3.0-or-later
// What every victim's command line has: --archive DIR --log-acks NUMBER [--die-at POINT:N]
// [--mutant NAME], for those that capture --clock virtual|real and --duration 2s.
#pragma once

#include <functional>
#include <string>

#include "db/archive.h"

namespace patina::testing {

struct VictimArguments {
  std::string archive, clock = "virtual", duration = "24h";
  int acks = -1;
  std::string point;
  int passing = 0;
  // "no_file_sync" "no_folder_sync" "synchronous_normal"
  db::ArchiveOptions::Mutant mutant = db::ArchiveOptions::Mutant::kNone;
};
VictimArguments parseVictimArguments(int argc, char** argv);  // exits 64 when they make no sense

// Raises SIGKILL at the chosen passing of the chosen point; empty when none was chosen.
std::function<void(db::CommitPoint)> dieAtPoint(const VictimArguments& arguments);

void tellAck(int acks, const std::string& run, db::RowId shot, int file, const std::string& sha256,
             std::int64_t bytes);

}  // namespace patina::testing
