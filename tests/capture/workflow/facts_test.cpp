// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/facts.h"

#include <gtest/gtest.h>

#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

TEST(Facts, ComeBackFromJsonAsTheyWere) {
  Facts facts;
  facts.text("name", "\"banana\"\n").count("frames", 252).number("gain", 0.1);
  facts.set("whole", true).set("inputs", std::vector<std::string>{"a", "b"});
  const Facts again = Facts::parse(facts.json());
  EXPECT_EQ(again.json(), facts.json());
  EXPECT_EQ(again.text("name"), "\"banana\"\n");
  EXPECT_EQ(again.number("frames"), 252);
  EXPECT_TRUE(again.flag("whole"));
  EXPECT_FALSE(again.flag("frames"));
  EXPECT_FALSE(again.text("frames"));
}

TEST(Facts, KeepTheirFirstPlaceWhenSetAgain) {
  Facts facts;
  facts.count("a", 1).count("b", 2).count("a", 3);
  EXPECT_EQ(facts.json(), R"({"a":3,"b":2})");
}

TEST(Facts, TakeTextThatIsNotUtf8) {
  Facts facts;
  facts.text("name", "\xff\xfe");
  EXPECT_NO_THROW(Facts::parse(facts.json()));
}

TEST(Facts, RefuseWhatIsNoObject) {
  EXPECT_THROW(Facts::parse("[1]"), WorkflowError);
  EXPECT_THROW(Facts::parse("{"), WorkflowError);
  EXPECT_TRUE(Facts::parse("").all().empty());
}

}  // namespace
}  // namespace patina::workflow
