// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>

#include "processing/render/font.h"

namespace patina::render {
namespace {

TEST(FontOutlines, EndEveryGlyphWithASemicolonAndHoldOnlyTheirOwnAlphabet) {
  const std::string text = kFontOutlines;
  EXPECT_EQ(text.back(), ';');
  EXPECT_EQ(text.find_first_not_of("0123456789- ;Mhvlq"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), ';'), 120);
}

}  // namespace
}  // namespace patina::render
