// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

const std::string kPlan = sourceFolder() / "examples/quick/plan.toml";

TEST(Output, JsonIsOneObjectWithSchemaAndItems) {
  const Finished finished = runPatina({"plan", "check", kPlan, "--json"});
  ASSERT_EQ(finished.exit, 0) << finished.err;
  const auto answer = parsed(finished.out);
  ASSERT_TRUE(answer.is_object()) << finished.out;
  EXPECT_EQ(answer["schema"], "patina.plan.check/1");
  ASSERT_TRUE(answer["items"].is_array());
  EXPECT_EQ(answer["items"][0]["interval_ns"], 600'000'000'000);
}

TEST(Output, PeopleReadUnitsInsteadOfNanoseconds) {
  const Finished finished = runPatina({"plan", "check", kPlan});
  EXPECT_THAT(finished.out, HasSubstr("interval         10min\n"));
  EXPECT_THAT(finished.out, ::testing::Not(HasSubstr("_ns")));
}

TEST(Output, AnErrorUnderJsonIsOneObjectOnTheErrorStream) {
  const Finished finished = runPatina({"plan", "check", "no such plan.toml", "--json"});
  EXPECT_EQ(finished.out, "");
  const auto answer = parsed(finished.err);
  ASSERT_TRUE(answer.is_object()) << finished.err;
  EXPECT_EQ(answer["error"]["exit"], finished.exit);
  EXPECT_THAT(answer["error"]["message"].get<std::string>(), HasSubstr("no such plan.toml"));
}

TEST(Output, AUsageErrorUnderJsonIsJsonToo) {
  const Finished finished = runPatina({"plan", "check", "--json", "--wilt"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_EQ(parsed(finished.err)["error"]["exit"], 64) << finished.err;
}

}  // namespace
}  // namespace patina::testing
