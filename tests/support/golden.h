// SPDX-License-Identifier: GPL-3.0-or-later
// Golden files: what a result once was, in tests/golden/. PATINA_UPDATE_GOLDEN=1 writes them anew;
// look at the difference before committing. tests/golden/README.md lists each file with its
// command, metric and tolerance.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "processing/image/image.h"

namespace patina::testing {

// EXPECT_TRUE(matchesGolden("plan_check.txt", text));   byte for byte; names the first line that
// differs.
::testing::AssertionResult matchesGolden(const std::string& name, const std::string& text);

// EXPECT_TRUE(matchesGolden("quilt.pfm", image, 1e-5));   one or three channels, kept as a PFM of
// 32-bit floats; `tolerance` is the largest absolute difference of a value.
::testing::AssertionResult matchesGolden(const std::string& name, ImageView<const float> image,
                                         double tolerance);

}  // namespace patina::testing
