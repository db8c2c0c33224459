// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/simd_path.h"

#include <gtest/gtest.h>

#include "processing/image/failure.h"

namespace patina {
namespace {

TEST(SimdPath, IsTheBestThereIsUnlessLessIsAskedFor) {
  EXPECT_EQ(chooseSimdPath("", SimdPath::kAvx2), SimdPath::kAvx2);
  EXPECT_EQ(chooseSimdPath("baseline", SimdPath::kAvx512), SimdPath::kBaseline);
  EXPECT_EQ(chooseSimdPath("avx512", SimdPath::kAvx512), SimdPath::kAvx512);
}

TEST(SimdPath, RefusesMoreThanTheProcessorHasAndUnknownWords) {
  const auto exitOf = [](const char* asked) {
    try {
      chooseSimdPath(asked, SimdPath::kAvx2);
    } catch (const ProcessingError& e) {
      return e.exit();
    }
    return Exit::kOk;
  };
  EXPECT_EQ(exitOf("avx512"), Exit::kUnavailable);
  EXPECT_EQ(exitOf("AVX2"), Exit::kConfig);
}

}  // namespace
}  // namespace patina
