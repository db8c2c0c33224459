// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

TEST(Signals, AReaderThatGoesAwayIsNoDeath) {
  const Finished finished =
      run({"/bin/sh", "-c", program().string() + " --help | true; echo ${PIPESTATUS:-0}"});
  EXPECT_EQ(finished.exit, 0) << finished.err;
  EXPECT_EQ(finished.signal, 0);
  EXPECT_EQ(finished.err, "");
}

TEST(Signals, AFullStandardOutputIsAnErrorOfTheDisk) {
  const Finished finished = run({"/bin/sh", "-c", program().string() + " --help > /dev/full"});
  EXPECT_EQ(finished.exit, 74);
}

}  // namespace
}  // namespace patina::testing
