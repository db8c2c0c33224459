// SPDX-License-Identifier: GPL-3.0-or-later
// A victim of the kill driver: commits frames of noise as fast as it can.
#include <cstdio>
#include <exception>

#include "tests/support/disk/archive_life.h"
#include "tests/system/victim.h"

int main(int argc, char** argv) {
  using namespace patina;
  const testing::VictimArguments arguments = testing::parseVictimArguments(argc, argv);
  try {
    db::ArchiveOptions options;
    options.folder = arguments.archive;
    options.owner = "commit victim";
    options.at_point = testing::dieAtPoint(arguments);
    options.mutant = arguments.mutant;
    testing::liveOn(options, 1'000'000, 1, [&](const testing::Acked& acked) {
      testing::tellAck(arguments.acks, "victim", acked.shot_id, 0, acked.sha256, 0);
    });
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 74;
  }
  return 0;
}
