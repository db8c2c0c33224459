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
  const JsonAnswer answer =
      answerOf(runPatina({"plan", "check", sourceFolder() / "examples/quick/plan.toml", "--json"}));
  EXPECT_EQ(answer.number("/items/0/steps"), 12);
  EXPECT_EQ(answer.number("/items/0/shots"), 12);
  EXPECT_EQ(answer.size("/items/0/warnings"), 0);
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
  const std::string plan = planWith("interval = \"10min\"", "interval = \"50ms\"");
  const JsonAnswer answer = answerOf(runPatina({"plan", "check", plan, "--json"}));
  EXPECT_GT(answer.size("/items/0/warnings"), 0);
}

}  // namespace
}  // namespace patina::testing
