// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/victim.h"

#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

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
    if (name == "--plan") arguments.plan = value;
    if (name == "--speed") arguments.speed = std::atof(value.c_str());
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
               "[--clock real] [--duration 24h] [--plan FILE] [--speed 20]\n",
               argv[0]);
  std::exit(64);
}

std::function<void(db::CommitPoint)> dieAtPoint(const VictimArguments& arguments) {
  if (arguments.point.empty()) return {};
  return [point = arguments.point, left = arguments.passing](db::CommitPoint p) mutable {
    if (point == db::name(p) && --left == 0) ::raise(SIGKILL);
  };
}

std::string victimRig() {
  return R"(name = "bench"
[[camera]]
id = "cam0"
backend = "twin"
settings = { format = "jpeg" }
[[light]]
id = "key"
backend = "twin"
between = "on"
[twin]
specimen = "grey_card"
size = "64x48"
)";
}

std::string victimPlan(const std::string& duration) {
  return "duration = \"" + duration + R"("
rig = "rig.toml"
specimen = "card"
interval = "50ms"
[[sweep]]
lights = [["key"], []]
exposures = ["1/100"]
[disk]
reserve = "1MB"
)";
}

std::filesystem::path writeVictimPlan(const std::filesystem::path& folder,
                                      const std::string& duration) {
  std::ofstream(folder / "rig.toml") << victimRig();
  std::ofstream(folder / "plan.toml") << victimPlan(duration);
  return folder / "plan.toml";
}

void tellAck(int acks, const std::string& run, db::RowId shot, int file, const std::string& sha256,
             std::int64_t bytes) {
  const std::string line = "ack " + run + " " + std::to_string(shot) + " " + std::to_string(file) +
                           " " + sha256 + " " + std::to_string(bytes) + "\n";
  if (::write(acks, line.data(), line.size()) != static_cast<ssize_t>(line.size())) std::exit(74);
}

Acked parseAck(const std::string& line) {
  std::istringstream words(line);
  std::string ack, run, bytes;
  Acked acked;
  acked.step = -1;
  if (!(words >> ack >> run >> acked.shot_id >> acked.shot >> acked.sha256 >> bytes) ||
      ack != "ack" || acked.sha256.size() != 64)
    throw std::runtime_error("no acknowledgement: " + line);
  return acked;
}

}  // namespace patina::testing
