// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "capture/app/http/metrics.h"

namespace patina::http {
namespace {

// The fields of /proc/self/stat from the state on: the name before them may hold spaces.
std::vector<double> statFields() {
  std::ifstream file("/proc/self/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return {};
  std::istringstream words(line.substr(end_of_name + 4));  // past ") S"
  std::vector<double> fields;
  for (double value; words >> value;) fields.push_back(value);
  return fields;
}

// UTC of the boot, which the start of a process is counted from.
std::optional<double> bootSeconds() {
  std::ifstream file("/proc/stat");
  for (std::string word; file >> word;)
    if (double seconds = 0; word == "btime" && file >> seconds) return seconds;
  return std::nullopt;
}

}  // namespace

void collectProcess(Metrics& metrics) {
  // Numbers of proc(5) less the four that statFields() leaves out.
  constexpr std::size_t kUserTicks = 14 - 4, kSystemTicks = 15 - 4, kThreads = 20 - 4,
                        kStartTicks = 22 - 4, kVirtualBytes = 23 - 4, kResidentPages = 24 - 4;
  const auto fields = statFields();
  if (fields.size() > kResidentPages) {
    const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    Counter& cpu = metrics.counter("process_cpu_seconds_total");
    cpu.add((fields[kUserTicks] + fields[kSystemTicks]) / ticks - cpu.value());
    metrics.gauge("process_threads").set(fields[kThreads]);
    metrics.gauge("process_virtual_memory_bytes").set(fields[kVirtualBytes]);
    metrics.gauge("process_resident_memory_bytes")
        .set(fields[kResidentPages] * static_cast<double>(sysconf(_SC_PAGESIZE)));
    if (const auto boot = bootSeconds())
      metrics.gauge("process_start_time_seconds").set(*boot + fields[kStartTicks] / ticks);
  }
  std::error_code error;
  double open = -1;  // the iterator's own
  for (std::filesystem::directory_iterator it("/proc/self/fd", error), end; !error && it != end;
       it.increment(error))
    ++open;
  if (!error) metrics.gauge("process_open_fds").set(open);
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0)
    metrics.gauge("process_max_fds").set(static_cast<double>(limit.rlim_cur));
}

}  // namespace patina::http
