// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/victim.h"

#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

namespace patina::testing {
namespace {

using Mutant = db::ArchiveOptions::Mutant;

Mutant parseMutant(const std::string& name) {
  if (name == "no_file_sync") return Mutant::kNoFileSync;
  if (name == "no_folder_sync") return Mutant::kNoFolderSync;
  if (name == "synchronous_normal") return Mutant::kSynchronousNormal;
  std::fprintf(stderr, "there is no mutant %s\n", name.c_str());
  std::exit(64);
}

}  // namespace

VictimArguments parseVictimArguments(int argc, char** argv) {
  VictimArguments arguments;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--archive") arguments.archive = value;
    if (name == "--log-acks") arguments.acks = std::atoi(value.c_str());
    if (name == "--clock") arguments.clock = value;
    if (name == "--duration") arguments.duration = value;
    if (name == "--mutant") arguments.mutant = parseMutant(value);
    if (name == "--die-at") {
      const auto colon = value.find(':');
      arguments.point = value.substr(0, colon);
      arguments.passing = std::atoi(value.c_str() + colon + 1);
    }
  }
  if (!arguments.archive.empty() && arguments.acks >= 0) return arguments;
  std::fprintf(stderr,
               "%s --archive DIR --log-acks NUMBER [--die-at POINT:N] [--mutant NAME] "
               "[--clock real] [--duration 24h]\n",
               argv[0]);
  std::exit(64);
}

std::function<void(db::CommitPoint)> dieAtPoint(const VictimArguments& arguments) {
  if (arguments.point.empty()) return {};
  return [point = arguments.point, left = arguments.passing](db::CommitPoint p) mutable {
    if (point == db::name(p) && --left == 0) ::raise(SIGKILL);
  };
}

void tellAck(int acks, const std::string& run, db::RowId shot, int file, const std::string& sha256,
             std::int64_t bytes) {
  const std::string line = "ack " + run + " " + std::to_string(shot) + " " + std::to_string(file) +
                           " " + sha256 + " " + std::to_string(bytes) + "\n";
  if (::write(acks, line.data(), line.size()) != static_cast<ssize_t>(line.size())) std::exit(74);
}

}  // namespace patina::testing
