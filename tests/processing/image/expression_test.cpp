// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/expression.h"

#include <gmock/gmock.h>

#include <cmath>

namespace patina {
namespace {

TEST(Expression, IsWorkedOutForItsVariables) {
  Expression e("2*x + y^2 - (x > y ? 1 : 0)", {"x", "y"});
  EXPECT_DOUBLE_EQ(e.at({3, 2}), 9);
  EXPECT_DOUBLE_EQ(e.at({1, 2}), 6);
  EXPECT_DOUBLE_EQ(Expression("atan2(1, 0) - pi/2", {}).at({}), 0);
}

TEST(Expression, SaysWhichVariablesItUses) {
  EXPECT_THAT(Expression("slope + 1", {"x", "slope", "light"}).used(),
              ::testing::ElementsAre("slope"));
}

std::string messageOf(const std::string& text) {
  try {
    Expression(text, {"x", "y"});
  } catch (const ProcessingError& error) {
    return error.what();
  }
  return "";
}

TEST(Expression, NamesWhatIsWrongWithIt) {
  EXPECT_THAT(messageOf("x + speed"), ::testing::HasSubstr("no 'speed'; variables are x, y"));
  EXPECT_THAT(messageOf("x + (y"), ::testing::HasSubstr("'x + (y'"));
  EXPECT_NE(messageOf("x +"), "");
  EXPECT_NE(messageOf(""), "");
}

TEST(Expression, LetsWhatIsNoNumberOut) {
  EXPECT_TRUE(std::isnan(Expression("x/x", {"x"}).at({0})));
}

}  // namespace
}  // namespace patina
