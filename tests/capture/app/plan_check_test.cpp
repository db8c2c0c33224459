// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

// A copy of the quick example with one line of its plan changed.
class PlanCheck : public ::testing::Test {
 protected:
  std::string planWith(const std::string& from, const std::string& to) {
    std::string plan = readFile(sourceFolder() / "examples/quick/plan.toml");
    const std::size_t at = plan.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    plan.replace(at, from.size(), to);
    writeFile(folder_ / "plan.toml", plan);
    writeFile(folder_ / "rig.toml", readFile(sourceFolder() / "examples/quick/rig.toml"));
    return folder_ / "plan.toml";
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(PlanCheck, CountsStepsAndShots) {
  const auto item =
      itemOf(runPatina({"plan", "check", sourceFolder() / "examples/quick/plan.toml", "--json"}));
  EXPECT_EQ(item["steps"], 12);
  EXPECT_EQ(item["shots"], 12);
  EXPECT_TRUE(item["warnings"].empty()) << item["warnings"];
}

TEST_F(PlanCheck, AnUnknownKeyIsNamedWithFileAndLine) {
  const std::string plan = planWith("seed = 1", "sed = 1");
  const Finished finished = runPatina({"plan", "check", plan});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr(plan + ":4: sed"));
}

TEST_F(PlanCheck, AnIntervalOfZeroIsOutOfRange) {
  const Finished finished =
      runPatina({"plan", "check", planWith("interval = \"10min\"", "interval = \"0s\"")});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr("interval"));
  EXPECT_THAT(finished.err, HasSubstr("50ms"));
}

TEST_F(PlanCheck, ALightThatTheRigDoesNotHaveIsNamed) {
  const Finished finished = runPatina({"plan", "check", planWith("[[\"key\"]]", "[[\"moon\"]]")});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr("moon"));
}

TEST_F(PlanCheck, ASweepLongerThanTheIntervalIsAWarning) {
  const Finished finished = runPatina(
      {"plan", "check", planWith("exposures = [\"1/50\"]", "exposures = [\"30s\"]"), "--json"});
  const auto longer = runPatina(
      {"plan", "check", planWith("interval = \"10min\"", "interval = \"50ms\""), "--json"});
  EXPECT_EQ(finished.exit, 0) << finished.err;
  EXPECT_EQ(longer.exit, 0) << longer.err;
  EXPECT_FALSE(itemOf(longer)["warnings"].empty());
}

}  // namespace
}  // namespace patina::testing
