// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/backends.h"

#include <gtest/gtest.h>

#include <set>

namespace patina::rig {
namespace {

TEST(Backends, HaveNamesOfTheirOwnAndMakeSomething) {
  std::set<std::string> names;
  for (const Backend& backend : backends()) {
    EXPECT_TRUE(names.insert(backend.name).second) << backend.name;
    EXPECT_TRUE(backend.camera || backend.light || backend.sensor || backend.trigger)
        << backend.name;
    EXPECT_EQ(backendNamed(backend.name), &backend);
  }
  EXPECT_EQ(backendNamed("telepathy"), nullptr);
}

}  // namespace
}  // namespace patina::rig
