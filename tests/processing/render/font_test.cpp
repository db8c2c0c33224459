// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/font.h"

#include <gtest/gtest.h>

namespace patina::render {
namespace {

TEST(Font, KnowsEveryPrintableCharacterOfAscii) {
  for (char c = ' '; c <= '~'; ++c) {
    const std::string text(1, c);
    EXPECT_GT(textWidth(text, 16), 0) << text;
    EXPECT_EQ(textOutlines(text, 16).empty(), c == ' ') << text;
  }
  EXPECT_LT(textWidth("i", 16), textWidth("m", 16));
}

TEST(Font, AddsWidthsAndScalesThem) {
  EXPECT_NEAR(textWidth("day 2", 26), 2 * textWidth("day 2", 13), 1e-9);
  EXPECT_NEAR(textWidth("ab", 13), textWidth("a", 13) + textWidth("b", 13), 1e-9);
}

TEST(Font, DrawsALetterOnItsBaseline) {
  double top = 0, bottom = -100;
  for (const auto& contour : textOutlines("H", 100))
    for (const Point& p : contour) {
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  EXPECT_NEAR(top, -72.9, 0.5);  // the height of capitals in this face
  EXPECT_NEAR(bottom, 0, 0.5);
}

TEST(Font, ReadsUtf8AndSurvivesWhatIsNot) {
  EXPECT_NE(textWidth("\xC2\xB0", 13), textWidth("?", 13));  // degree sign
  EXPECT_EQ(textWidth("\xE6\x97\xA5", 13), textWidth("?", 13));
  for (const std::string text : {"\xC2", "\xFF\xFE", "\xE6\x97", "\x80", "a\xC2z"})
    EXPECT_GT(textWidth(text, 13), 0);
}

}  // namespace
}  // namespace patina::render
