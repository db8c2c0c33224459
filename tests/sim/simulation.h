// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run on the twin, in virtual time, with faults: what every simulation starts from.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "capture/session.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {

struct SimulationOptions {
  std::string interval = "10min", duration = "2h";
  std::string plan = {};         // more lines at the top of the plan
  std::string light_check = {};  // lines of [light_check]
  std::string lights = R"([["key"]])", exposures = R"(["1/50"])";
  std::string rig = {};  // more tables of the rig
  std::string between = "off";
  std::string format = "jpeg";
  int cameras = 1;
  std::string size = "64x48";
  std::string faults = {};  // of [[fault]] tables
  std::string specimen = "grey_card";
  std::uint64_t seed = 1;
};

// One rig, one plan and one archive in memory; runs as often as the test kills it.
class Simulation {
 public:
  explicit Simulation(const SimulationOptions& options);

  // Opens the archive, builds the rig, runs until the end or until `stop` is asked for.
  capture::SessionSummary run(const std::function<void(capture::SessionHooks&)>& prepare = {});

  const db::ArchiveReader& reader();  // after run()
  // Nothing lost, nothing doubled, catalogue == frame store, one row for every slot due.
  void expectWhole();
  std::vector<std::string> decisions();  // "captured" ..., by number
  std::vector<db::EventRow> events(const std::string& kind);

  SimulationOptions options;
  capture::Plan plan;
  devices::RigSpec rig_spec;
  devices::VirtualClock clock;
  db::ArchiveOptions archive_options;
  capture::SessionOptions session_options;
  std::string run_id;
  UtcTime t0;

 private:
  TempFolder folder_ = TempFolder::inMemory();
  std::unique_ptr<db::ArchiveReader> reader_;
};

}  // namespace patina::testing
