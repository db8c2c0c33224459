// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/palette.h"

#include <gtest/gtest.h>

namespace patina::render {
namespace {

int apart(Colour a, Colour b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

TEST(Palette, GivesNeighbouringSeriesDifferentColours) {
  for (int i = 0; i < 6; ++i) EXPECT_GT(apart(seriesColour(i), seriesColour(i + 1)), 60);
  EXPECT_EQ(apart(seriesColour(0), seriesColour(7)), 0);
  EXPECT_EQ(apart(seriesColour(-1), seriesColour(6)), 0);
}

TEST(Palette, TellsGoodFromBadVerdictsAndKnowsEveryDecision) {
  EXPECT_GT(apart(meaningColour("pass"), meaningColour("fail")), 150);
  EXPECT_GT(apart(meaningColour("hold"), meaningColour("fail")), 80);
  for (const char* word : {"captured", "skipped", "missed", "failed", "held"})
    EXPECT_GT(apart(meaningColour(word), kWhite), 100) << word;
  EXPECT_EQ(apart(meaningColour("held"), meaningColour("hold")), 0);
}

}  // namespace
}  // namespace patina::render
