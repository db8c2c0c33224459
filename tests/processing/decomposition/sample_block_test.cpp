// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/sample_block.h"

#include <gtest/gtest.h>

namespace patina::decomposition {
namespace {

constexpr Index kRows = 5, kTexels = 7;

TEST(FloatRows, OfFloatsLieWhereTheyAre) {
  const std::vector<float> samples(kRows * kTexels, 1.0f);
  const SampleBlock block{.data = samples.data(), .count = kTexels, .stride = kTexels};
  std::vector<float> room;
  const FloatRows rows = floatRows(block, 2, 3, 4, 3, room);
  EXPECT_EQ(rows.data, &samples[2 * kTexels + 4]);
  EXPECT_EQ(rows.stride, kTexels);
  EXPECT_TRUE(room.empty());
  EXPECT_EQ(block.rowsAtOnce(1000), 1000);
}

TEST(FloatRows, OfCodesAreSoManySteps) {
  std::vector<std::uint8_t> codes;
  for (Index i = 0; i < kRows * kTexels; ++i) codes.push_back(static_cast<std::uint8_t>(7 * i));
  const SampleBlock block{
      .codes = codes.data(), .step = 0.5f, .count = kTexels - 1, .stride = kTexels};
  std::vector<float> room;
  const FloatRows rows = floatRows(block, 2, 3, 1, 4, room);
  for (Index j = 0; j < 3; ++j)
    for (Index i = 0; i < 4; ++i)
      EXPECT_EQ(rows.data[j * rows.stride + i], 0.5f * codes[(2 + j) * kTexels + 1 + i]);
  EXPECT_LT(block.rowsAtOnce(1000), 1000);
  EXPECT_EQ(block.rowsAtOnce(kRows), kRows);
}

}  // namespace
}  // namespace patina::decomposition
