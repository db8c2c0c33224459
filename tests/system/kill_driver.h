// SPDX-License-Identifier: GPL-3.0-or-later
// Kills a capturing program again and again and holds its archive to what it acknowledged. The
// expected state lives here, in another process than the victim's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/disk/archive_life.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {

// A program that opens the archive {archive}, goes on with its run and writes to the open file
// number {acks} a line for each frame, after its acknowledgement and before its next shot:
//   ack RUN SHOT_ID FILE_INDEX SHA256 BYTES
struct VictimProgram {
  std::vector<std::string> command;
  // The same with a hook in it: takes "--die-at POINT:N", which is SIGKILL to itself at the N-th
  // passing of that point of the commit. Every other life is its; empty: there is none.
  std::vector<std::string> point_command;
};

class KillDriver {
 public:
  KillDriver(VictimProgram program, std::uint64_t seed);

  // One life, its death and the broken promises it leaves: something acknowledged lost or doubled,
  // a step without its one row, `verify` not clean (every other time, after a recovery of ours;
  // else the victim's next life recovers).
  std::vector<std::string> kill(int round);

  std::filesystem::path archive() const { return folder_ / "archive"; }
  std::size_t acked() const { return judge_.count(); }
  int at_points() const { return at_points_; }
  // From the start of a process to its first acknowledgement, the longest.
  Nanoseconds slowestStart() const { return slowest_start_; }

 private:
  std::vector<std::string> judge(bool recovered) const;
  struct Death;  // how a life ends
  Death chooseDeath(int round, std::vector<std::string>* command);
  void fillIn(std::vector<std::string>& command, int acks) const;

  VictimProgram program_;
  std::uint64_t seed_;
  TempFolder folder_ = TempFolder::inMemory();
  Judge judge_;
  int at_points_ = 0;
  Nanoseconds slowest_start_{};
};

}  // namespace patina::testing
