// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(StbrdfFit, WritesASetAndItsErrorsAndKeepsWhatIsThere) {
  const TempFolder temp;
  const fs::path steps = plantSteps(temp / "steps", 6), out = temp / "set";
  const Finished fit = runPatina({"stbrdf", "fit", steps, "--degree", "2", "--errors",
                                  temp / "errors", "--out", out, "--json"});
  ASSERT_EQ(fit.exit, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("patina.stbrdf.fit/1"));
  for (const char* name : {"Diffuse-0.exr", "Diffuse-2.exr", "Roughness-1.exr", "manifest.json"})
    EXPECT_TRUE(fs::exists(out / name)) << name;
  EXPECT_NEAR(readPicture(out / "Diffuse-2.exr").linear.at(3, 3, 1), 0.5, 1e-5);
  EXPECT_LT(readPicture(temp / "errors/Roughness.exr").linear.at(0, 0), 1e-6);
  const Finished again = runPatina({"stbrdf", "fit", steps, "--out", out});
  EXPECT_EQ(again.exit, 73);
  EXPECT_THAT(again.err, HasSubstr("is there already"));
}

TEST(StbrdfFit, ChoosesADegreeAndWarnsOfOneThatOverfits) {
  const TempFolder temp;
  const fs::path steps = plantSteps(temp / "steps", 7);
  const Finished automatic =
      runPatina({"stbrdf", "fit", steps, "--degree", "auto", "--out", temp / "auto"});
  ASSERT_EQ(automatic.exit, 0) << automatic.err;
  EXPECT_THAT(automatic.out, HasSubstr("degree 2 by cross-validation"));
  const Finished much = runPatina({"stbrdf", "fit", steps, "--degree", "6", "--out", temp / "6"});
  EXPECT_EQ(much.exit, 0) << much.err;
  EXPECT_THAT(much.err, HasSubstr("degree 6 over-fits Diffuse"));
}

TEST(StbrdfFit, TakesBoundsMapsAndFactors) {
  const TempFolder temp;
  const fs::path steps = plantSteps(temp / "steps", 6);
  const Finished one = runPatina(
      {"stbrdf", "fit", steps, "--map", "Diffuse", "--bounded", "--out", temp / "one", "--json"});
  EXPECT_EQ(one.exit, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("bounded_share"));
  EXPECT_FALSE(fs::exists(temp / "one/Roughness-0.exr"));
  const Finished staf = runPatina({"stbrdf", "fit", steps, "--as", "staf", "--out", temp / "staf"});
  EXPECT_EQ(staf.exit, 0) << staf.err;
  EXPECT_TRUE(fs::exists(temp / "staf/staf-Kd-phi.txt"));
}

TEST(StbrdfFit, RefusesWhatCannotBeAndLeavesNothing) {
  const TempFolder temp;
  const fs::path steps = plantSteps(temp / "steps", 3), out = temp / "set";
  const auto refused = [&](std::vector<std::string> arguments) {
    std::vector<std::string> all{"stbrdf", "fit", "--out", out};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Finished finished = runPatina(all);
    EXPECT_FALSE(fs::exists(out));
    return std::to_string(finished.exit) + " " + finished.err;
  };
  EXPECT_THAT(refused({steps, "--degree", "3"}), HasSubstr("needs 4 different times"));
  EXPECT_THAT(refused({steps, "--degree", "13"}), HasSubstr("--degree is '13'"));
  EXPECT_THAT(refused({steps, "--as", "splines"}), HasSubstr("--as is 'splines'"));
  EXPECT_THAT(refused({}), HasSubstr("64 "));
  EXPECT_THAT(refused({temp / "nowhere"}), HasSubstr("65 "));
  writeExr(steps / "t0001/Diffuse.exr", Image<float>(8, 5, 3, 0.1f).view());
  EXPECT_THAT(refused({steps, "--degree", "1"}), HasSubstr("Diffuse of step 1 is 8x5"));
}

}  // namespace
}  // namespace patina::testing
