// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/labels.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace patina::patch {
namespace {

constexpr int kSource = 8, kTarget = 20;

std::size_t indexOf(int x, int y) {
  return static_cast<std::size_t>(y) * kTarget + static_cast<std::size_t>(x);
}

// A source whose right half has label 3; a copy of it that begins at 10,-2 may be shown anywhere.
Labels rightHalf() {
  Labels labels{.source = {kSource, kSource}, .target = {kTarget, kTarget}, .slack = 2};
  for (int i = 0; i < kSource * kSource; ++i)
    labels.of_source.push_back(i % kSource < kSource / 2 ? -1 : 3);
  labels.of_target.assign(kTarget * kTarget, {3, 10, -2});
  return labels;
}

TEST(Labels, RefuseWhatTheTargetDoesNotHave) {
  Labels labels = rightHalf();
  const std::int32_t labelled = 4 * kSource + 5;
  EXPECT_FALSE(labels.refuse(labelled, indexOf(15, 2)));
  labels.of_target[indexOf(15, 2)].label = 2;
  EXPECT_TRUE(labels.refuse(labelled, indexOf(15, 2)));
  labels.of_target[indexOf(15, 2)].label = -1;
  EXPECT_TRUE(labels.refuse(labelled, indexOf(15, 2)));
  EXPECT_FALSE(labels.refuse(4 * kSource + 2, indexOf(15, 2)));
  EXPECT_FALSE(Labels{}.refuse(labelled, indexOf(15, 2)));
}

TEST(Labels, RefuseACopyThatBeginsElsewhere) {
  const Labels labels = rightHalf();
  const std::int32_t labelled = 4 * kSource + 5;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      EXPECT_EQ(labels.refuse(labelled, indexOf(x, y)), std::abs(x - 15) > 2 || std::abs(y - 2) > 2)
          << x << "," << y;
}

TEST(Labels, KnowACopyOnTheOtherSideWhereTheTargetWraps) {
  Labels labels = rightHalf();
  const std::int32_t labelled = kSource - 1;
  for (const bool wraps : {false, true}) {
    labels.wraps = wraps;
    EXPECT_FALSE(labels.refuse(labelled, indexOf(17, 0)));
    EXPECT_EQ(labels.refuse(labelled, indexOf(17, 19)), !wraps);
    EXPECT_TRUE(labels.refuse(labelled, indexOf(17, 15)));
  }
}

}  // namespace
}  // namespace patina::patch
