// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/gphoto2/bench.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

using Driver = DriverTest;

TEST_F(Driver, HandsOverThePictureThatTheCameraTook) {
  open();
  const auto frames = tryShot(1);
  ASSERT_THAT(frames, IsOk());
  ASSERT_EQ(frames->size(), 1u);
  expectOurs(*frames);
  const RawFrame& frame = frames->front();
  EXPECT_EQ(frame.ext, "jpg");
  EXPECT_EQ(frame.sequence, 1u);
  EXPECT_EQ(frame.declared_bytes, static_cast<std::int64_t>(frame.bytes.size()));
}

TEST_F(Driver, PairsRawAndJpegInThatOrder) {
  use(serial("1001"), {{"format", "raw+jpeg"}, {"raw_extension", "dng"}});
  open();
  EXPECT_THAT(driver().caps().extensions, ::testing::ElementsAre("dng", "jpg"));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    const auto frames = tryShot(i);
    ASSERT_THAT(frames, IsOk());
    ASSERT_EQ(frames->size(), 2u);
    EXPECT_EQ((*frames)[0].ext, "dng");
    EXPECT_EQ((*frames)[1].ext, "jpg");
    expectOurs(*frames);
  }
}

TEST_F(Driver, DeletesOnlyWhatIsReleased) {
  open();
  const auto first = tryShot(1), second = tryShot(2);
  ASSERT_THAT(first, IsOk());
  ASSERT_THAT(second, IsOk());
  EXPECT_EQ(onCard(), 2u);
  ASSERT_THAT(driver().release(first->front()), IsOk());
  EXPECT_EQ(onCard(), 1u);
  EXPECT_THAT(driver().release(first->front()), IsOk());
  EXPECT_EQ(onCard(), 1u);
}

}  // namespace
}  // namespace patina::devices::gphoto2
