// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/support/child.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(Context, AVerbThatNeedsAnArchiveSaysHowToNameOne) {
  const Finished finished = runPatina({"archive", "list"}, {"PATINA_ARCHIVE="});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("--archive"));
  EXPECT_THAT(finished.err, HasSubstr("PATINA_ARCHIVE"));
}

TEST(Context, TheEnvironmentNamesTheArchiveUnlessTheCommandLineDoes) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string one = folder / "one", other = folder / "other";
  EXPECT_THAT(runPatina({"archive", "list"}, {"PATINA_ARCHIVE=" + one}).err, HasSubstr(one));
  EXPECT_THAT(runPatina({"archive", "list", "--archive", other}, {"PATINA_ARCHIVE=" + one}).err,
              HasSubstr(other));
}

}  // namespace
}  // namespace patina::testing
