// SPDX-License-Identifier: GPL-3.0-or-later
// A victim of the kill driver: the daemon, all of it, with a hook at the points of the commit.
#include <cstdio>
#include <exception>

#include "capture/app/daemon/daemon.h"
#include "tests/system/victim.h"

int main(int argc, char** argv) {
  using namespace patina;
  const testing::VictimArguments arguments = testing::parseVictimArguments(argc, argv);
  try {
    devices::RealClock clock;
    daemon::DaemonOptions options;
    options.archive = arguments.archive;
    options.command = "daemon victim";
    options.start = arguments.plan;
    options.port = 0;
    options.speed = arguments.speed;
    options.log_acks = std::to_string(arguments.acks);
    options.say = [](const std::string&) {};
    options.at_point = testing::dieAtPoint(arguments);
    daemon::Daemon(options, clock).run({});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 74;
  }
  return 0;
}
