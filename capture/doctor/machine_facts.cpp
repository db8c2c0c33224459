// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>
#include <sys/timex.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "capture/doctor/facts.h"

namespace patina::doctor {
namespace {

namespace fs = std::filesystem;

std::string firstLine(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::optional<std::uint64_t> available(const fs::path& root) {
  std::ifstream file(root / "proc/meminfo");
  std::string key, unit;
  std::uint64_t kib = 0;
  std::optional<std::uint64_t> bytes;
  while (file >> key >> kib && std::getline(file, unit))
    if (key == "MemAvailable:") bytes = kib * 1024;
  // In a container or a unit with MemoryMax the group's limit is what counts.
  std::istringstream limit(firstLine(root / "sys/fs/cgroup/memory.max"));
  std::istringstream used(firstLine(root / "sys/fs/cgroup/memory.current"));
  std::uint64_t most = 0, now = 0;
  if (bytes && limit >> most && used >> now)
    bytes = std::min(*bytes, most > now ? most - now : std::uint64_t{0});
  return bytes;
}

std::vector<std::string> sleepStates(const fs::path& root) {
  std::istringstream words(firstLine(root / "sys/power/state"));
  std::vector<std::string> states;
  for (std::string word; words >> word;) states.push_back(word);
  return states;
}

// A masked unit is a link to /dev/null.
std::vector<std::string> unmasked(const fs::path& root) {
  std::vector<std::string> names;
  std::error_code error;
  if (!fs::is_directory(root / "run/systemd/system", error)) return names;
  for (const char* name :
       {"sleep.target", "suspend.target", "hibernate.target", "hybrid-sleep.target"}) {
    const fs::path unit = root / "etc/systemd/system" / name;
    if (!fs::is_symlink(unit, error) || fs::read_symlink(unit, error) != "/dev/null")
      names.emplace_back(name);
  }
  return names;
}

std::optional<bool> clockSynchronised() {
  timex state{};
  const int answer = ::adjtimex(&state);  // asks only: no mode is set
  if (answer < 0) return std::nullopt;
  return answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

}  // namespace

MachineFacts machineFacts(const fs::path& root) {
  MachineFacts facts;
  facts.clock_synchronised = clockSynchronised();
  facts.sleep_states = sleepStates(root);
  facts.unmasked_sleep = unmasked(root);
  facts.memory_free_bytes = available(root);
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) facts.descriptors = limit.rlim_cur;
  return facts;
}

}  // namespace patina::doctor
