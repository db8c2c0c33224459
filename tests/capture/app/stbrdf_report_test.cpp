// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(StbrdfReport, SetsPolynomialsBesideStafAndThePaper) {
  const TempFolder temp;
  const auto steps = plantSteps(temp / "steps", 7);
  const Finished report = runPatina({"stbrdf", "report", steps, "--json"});
  ASSERT_EQ(report.exit, 0) << report.err;
  EXPECT_THAT(report.out, HasSubstr("\"fit\":\"STAF\""));
  EXPECT_THAT(report.out, HasSubstr("\"fit\":\"d = 4\""));
  EXPECT_THAT(report.out, HasSubstr("\"paper_overall\":0.017"));
  EXPECT_THAT(report.out, HasSubstr("\"diffuse_b\""));
  const Finished one =
      runPatina({"stbrdf", "report", steps, "--degrees", "1,6", "--without-staf", "--json"});
  EXPECT_THAT(one.out, HasSubstr("\"fit\":\"d = 6\""));
  EXPECT_THAT(one.out, Not(HasSubstr("STAF")));
  EXPECT_EQ(runPatina({"stbrdf", "report", steps, "--degrees", "1,,2"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
