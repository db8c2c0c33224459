// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

TEST(StbrdfConvert, TakesSetsInAnotherBasisAndFactors) {
  const TempFolder temp;
  const auto steps = plantSteps(temp / "steps", 6);
  ASSERT_EQ(runPatina({"stbrdf", "fit", steps, "--degree", "2", "--out", temp / "set"}).exit, 0);
  const Finished legendre = runPatina({"stbrdf", "convert", temp / "set", "--basis",
                                       "shifted-legendre", "--out", temp / "legendre"});
  ASSERT_EQ(legendre.exit, 0) << legendre.err;
  // 0.2 + 0.5 t^2 has the mean 0.2 + 0.5 / 3.
  EXPECT_NEAR(readPicture(temp / "legendre/Diffuse-0.exr").linear.at(0, 0), 0.36667, 1e-5);
  ASSERT_EQ(runPatina({"stbrdf", "fit", steps, "--as", "staf", "--out", temp / "staf"}).exit, 0);
  const Finished staf =
      runPatina({"stbrdf", "convert", temp / "staf", "--out", temp / "from-staf", "--json"});
  ASSERT_EQ(staf.exit, 0) << staf.err;
  EXPECT_THAT(staf.out, ::testing::HasSubstr("\"degree\":6"));
  EXPECT_EQ(
      runPatina({"stbrdf", "convert", temp / "set", "--basis", "splines", "--out", temp / "x"})
          .exit,
      65);
}

}  // namespace
}  // namespace patina::testing
