// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/witness_drift.h"

#include <gtest/gtest.h>

#include <vector>

namespace patina::capture {
namespace {

db::LightCheckRow row(const std::string& source, const std::string& channel, double ratio,
                      const std::string& verdict = "correct") {
  db::LightCheckRow r;
  r.source = source;
  r.channel = channel;
  r.baseline = 0.4;
  r.ratio = ratio;
  r.verdict = verdict;
  return r;
}

TEST(WitnessDrift, NamesAPatchAndASensorThatHaveDriftedApart) {
  const std::vector<db::LightCheckRow> rows{row("patch:cam0", "r", 1.2),
                                            row("patch:cam0", "g", 1.061),
                                            row("sensor:lux0", "lx", 0.998, "pass")};
  EXPECT_EQ(driftedApart(rows, 0.05),
            "patch:cam0 (+6.1 %) and sensor:lux0 (-0.2 %) have drifted apart since they were "
            "learned: look at the patch");
  EXPECT_EQ(driftedApart(rows, 0.07), "");
}

TEST(WitnessDrift, SaysNothingWhileTheyDriftTogether) {
  const std::vector<db::LightCheckRow> rows{row("patch:cam0", "y", 0.9),
                                            row("sensor:lux0", "lx", 0.9)};
  EXPECT_EQ(driftedApart(rows, 0.05), "");
}

TEST(WitnessDrift, CountsOnlyWhatWasTakenAgainstABaseline) {
  const db::LightCheckRow patch = row("patch:cam0", "g", 1.3);
  EXPECT_NE(driftedApart(std::vector{patch, row("sensor:lux0", "lx", 1)}, 0.05), "");
  for (const char* verdict : {"learn", "hold", "covered", "at_odds", "saturated", "measure"})
    EXPECT_EQ(driftedApart(std::vector{patch, row("sensor:lux0", "lx", 1, verdict)}, 0.05), "")
        << verdict;
  EXPECT_EQ(driftedApart(std::vector{patch, row("sensor:air", "degC", 1)}, 0.05), "");
  db::LightCheckRow learns = row("sensor:lux0", "lx", 0);
  learns.baseline = 0;
  EXPECT_EQ(driftedApart(std::vector{patch, learns}, 0.05), "");
}

}  // namespace
}  // namespace patina::capture
