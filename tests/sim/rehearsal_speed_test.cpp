// SPDX-License-Identifier: GPL-3.0-or-later
// A rehearsal of many shots: what the session itself costs, and that equal seeds give equal hashes.
// PATINA_REHEARSAL_STEPS=120960 is a week at 5 s; only this long form looks at every row and file
// afterwards. No time is asserted: a busy machine is no fault of the program.
#include <gtest/gtest.h>
#include <linux/magic.h>
#include <sys/resource.h>
#include <sys/vfs.h>

#include <cstdlib>

#include "devices/clock.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

bool isTmpfs(const std::filesystem::path& folder) {
  struct statfs status {};
  return statfs(folder.c_str(), &status) == 0 && status.f_type == TMPFS_MAGIC;
}

// The shots, their speed and their hash; answers the hash.
std::string rehearse(const std::string& format, std::int64_t steps, bool look_at_everything) {
  Simulation sim({.interval = "5s",
                  .duration = formatDuration(steps * std::chrono::seconds(5)),
                  .format = format,
                  .specimen = "banana_ripening"});
  devices::RealClock real;
  const double cpu_before = cpuSeconds();
  const MonoTime before = real.mono();
  const auto summary = sim.run();
  const double wall_s = toSeconds(real.mono() - before), cpu_s = cpuSeconds() - cpu_before;
  const auto count = static_cast<double>(steps);
  std::printf("%s: %lld shots, %.0f shots a CPU second, %.0f shots a second of wall time%s\n",
              format.c_str(), static_cast<long long>(steps), count / cpu_s, count / wall_s,
              isTmpfs(sim.archive_options.folder) ? "" : " (not on tmpfs)");
  std::printf("%s: event log %s\n", format.c_str(), summary.event_log_sha256.c_str());
  EXPECT_EQ(summary.end, "finished");
  EXPECT_EQ(summary.last.captured, steps);
  if (look_at_everything) sim.expectWhole();
  return summary.event_log_sha256;
}

TEST(Rehearsal, IsTheSameTwiceAndSaysItsSpeed) {
  const char* text = std::getenv("PATINA_REHEARSAL_STEPS");
  const std::int64_t steps = text ? std::atoll(text) : 400;
  const std::string hash = rehearse("jpeg", steps, text != nullptr);
  EXPECT_EQ(rehearse("jpeg", steps, false), hash);
  EXPECT_NE(rehearse("dng", steps, text != nullptr), hash);
}

}  // namespace
}  // namespace patina::testing
