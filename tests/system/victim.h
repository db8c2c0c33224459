// SPDX-License-Identifier: GPL-3.0-or-later
// What every victim's command line has: --archive DIR --log-acks NUMBER [--die-at POINT:N]
// [--mutant NAME], for those that capture --clock virtual|real and --duration 2s; what they
// capture, and how they tell of it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "db/archive.h"
#include "tests/support/disk/archive_life.h"

namespace patina::testing {

struct VictimArguments {
  std::string archive, plan, clock = "virtual", duration = "24h";
  double speed = 0;  // of a daemon's time; 0: real time
  int acks = -1;
  std::string point;
  int passing = 0;
  // "no_file_sync" "no_folder_sync" "synchronous_normal"
  db::ArchiveOptions::Mutant mutant = db::ArchiveOptions::Mutant::kNone;
};
VictimArguments parseVictimArguments(int argc, char** argv);  // exits 64 when they make no sense

// Raises SIGKILL at the chosen passing of the chosen point; empty when none was chosen.
std::function<void(db::CommitPoint)> dieAtPoint(const VictimArguments& arguments);

// A small camera and two shots a step at the shortest interval there is.
std::string victimRig();
std::string victimPlan(const std::string& duration);
// Both as rig.toml and plan.toml; answers the plan's file.
std::filesystem::path writeVictimPlan(const std::filesystem::path& folder,
                                      const std::string& duration);

// "ack RUN SHOT_ID FILE_INDEX SHA256 BYTES", and back; throws what is no such line.
void tellAck(int acks, const std::string& run, db::RowId shot, int file, const std::string& sha256,
             std::int64_t bytes);
Acked parseAck(const std::string& line);

}  // namespace patina::testing
