// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class FrameOptions : public Rehearsed {};

TEST_F(FrameOptions, TakeEveryNthFrameOfATextureToo) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  EXPECT_EQ(answer({"film", file, place("y.mp4"), "--every", "5"}).number("/items/0/frames"), 3);
}

TEST_F(FrameOptions, NameWhatIsThereWhenTheInputIsNot) {
  const Finished no_archive = runPatina({"film", "gone.h5", place("z.mp4")}, {"PATINA_ARCHIVE="});
  EXPECT_EQ(no_archive.exit, 64);
  EXPECT_THAT(no_archive.err, HasSubstr("--archive"));
  EXPECT_EQ(patina({"film", "1999", place("z.mp4")}).exit, 64);
  EXPECT_EQ(patina({"film", "latest", place("z.avi")}).exit, 64);
  EXPECT_EQ(patina({"film", "latest", place("z.mp4"), "--light", "moon"}).exit, 64);
  EXPECT_EQ(patina({"film", quickPlan(), place("z.mp4")}).exit, 65);  // a file, but no texture
  EXPECT_EQ(patina({"film", "latest", place("z.mp4"), "--exposure-stops", "dark"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
