// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(StbrdfInfo, TellsWhatASetHoldsAndHowItMoves) {
  const TempFolder temp;
  ASSERT_EQ(runPatina({"stbrdf", "fit", plantSteps(temp / "steps", 5), "--degree", "2", "--out",
                       temp / "set"})
                .exit,
            0);
  const Finished info = runPatina({"stbrdf", "info", temp / "set"});
  EXPECT_EQ(info.exit, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("8x6 texels, degree 2 (monomial), ggx, alpha"));
  const Finished json = runPatina({"stbrdf", "info", temp / "set", "--json"});
  EXPECT_THAT(json.out, HasSubstr("\"map\":\"Roughness\""));
  EXPECT_EQ(runPatina({"stbrdf", "info", temp / "nowhere"}).exit, 65);
}

TEST(StbrdfInfo, WarnsWhereNothingTellsTheTimes) {
  const TempFolder temp;
  const auto steps = plantSteps(temp / "steps", 5);
  for (int i = 0; i < 5; ++i)
    std::filesystem::remove(steps / ("t000" + std::to_string(i)) / "manifest.json");
  const Finished fit = runPatina({"stbrdf", "fit", steps, "--degree", "1", "--out", temp / "set"});
  EXPECT_EQ(fit.exit, 0);
  EXPECT_THAT(fit.err, HasSubstr("nothing tells the times of the 5 steps"));
}

}  // namespace
}  // namespace patina::testing
