// SPDX-License-Identifier: GPL-3.0-or-later
// A rehearsal of many shots: what the session itself costs, and that equal seeds give equal hashes.
// PATINA_REHEARSAL_STEPS=120960 is the week of the issue.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>

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

TEST(Rehearsal, IsTheSameTwiceAndSaysItsSpeed) {
  const char* text = std::getenv("PATINA_REHEARSAL_STEPS");
  const std::int64_t steps = text ? std::atoll(text) : 400;
  std::string hash;
  for (const std::string format : {"jpeg", "jpeg", "dng"}) {
    Simulation sim({.interval = "5s",
                    .duration = formatDuration(steps * std::chrono::seconds(5)),
                    .format = format,
                    .specimen = "banana_ripening"});
    const double before = cpuSeconds();
    const auto summary = sim.run();
    const double seconds = cpuSeconds() - before;
    std::printf("%s: %lld shots, %.0f shots a CPU second\n", format.c_str(),
                static_cast<long long>(steps), static_cast<double>(steps) / seconds);
    EXPECT_EQ(summary.last.captured, steps);
    if (format != "jpeg") continue;
    if (!hash.empty()) {
      EXPECT_EQ(summary.event_log_sha256, hash);
    }
    hash = summary.event_log_sha256;
  }
}

}  // namespace
}  // namespace patina::testing
