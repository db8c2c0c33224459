// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

const std::string kPlan = sourceFolder() / "examples/quick/plan.toml";

TEST(Output, JsonIsOneObjectWithSchemaAndItems) {
  const JsonAnswer answer = answerOf(runPatina({"plan", "check", kPlan, "--json"}));
  EXPECT_EQ(answer.text("/schema"), "patina.plan.check/1");
  EXPECT_EQ(answer.size("/items"), 1);
  EXPECT_EQ(answer.number("/items/0/interval_ns"), 600e9);
}

TEST(Output, PeopleReadUnitsInsteadOfNanoseconds) {
  const Finished finished = runPatina({"plan", "check", kPlan});
  EXPECT_THAT(finished.out, HasSubstr("interval         10min\n"));
  EXPECT_THAT(finished.out, ::testing::Not(HasSubstr("_ns")));
}

TEST(Output, AnErrorUnderJsonIsOneObjectOnTheErrorStream) {
  const Finished finished = runPatina({"plan", "check", "no such plan.toml", "--json"});
  EXPECT_EQ(finished.out, "");
  const JsonAnswer answer(finished.err);
  EXPECT_EQ(answer.number("/error/exit"), finished.exit) << finished.err;
  EXPECT_THAT(answer.text("/error/message"), HasSubstr("no such plan.toml"));
}

TEST(Output, AUsageErrorUnderJsonIsJsonToo) {
  const Finished finished = runPatina({"plan", "check", "--json", "--wilt"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_EQ(JsonAnswer(finished.err).number("/error/exit"), 64) << finished.err;
}

}  // namespace
}  // namespace patina::testing
