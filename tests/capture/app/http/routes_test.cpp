// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/routes.h"

#include <gtest/gtest.h>

namespace patina::http {
namespace {

TEST(MatchPattern, GivesTheParametersOfAPath) {
  const auto found = matchPattern("/api/v1/runs/{run}/pause", "/api/v1/runs/latest/pause");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->at("run"), "latest");
}

}  // namespace
}  // namespace patina::http
