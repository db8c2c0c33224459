// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>

#include "devices/driver_notes.h"
#include "devices/gphoto2/clock_offset.h"
#include "tests/devices/gphoto2/bench.h"
#include "tests/support/temp_folder.h"

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

// Its tick takes a second to see, and bounds the offset to 40 ms at best.
TEST_F(Driver, AProcessBeforeItSparesItTheWaitForTheCamerasClock) {
  const testing::TempFolder notes = testing::TempFolder::inMemory();
  ::setenv(kDriverNotes, notes.path().c_str(), 1);
  MonoTime before{}, after{};
  Nanoseconds ahead{};
  do {
    before = clock_.mono();
    ahead = clock_.utc().time_since_epoch() - before.time_since_epoch();
    after = clock_.mono();
  } while (after - before > 2ms);
  const auto ns = [](Nanoseconds t) { return std::to_string(t.count()); };
  noteForDriver("clock of 1001",
                ns(ahead - 5ms) + " " + ns(ahead + 5ms) + " " + ns(before.time_since_epoch()));
  open();
  const ClockOffset learned = ClockOffset::of(driverNote("clock of 1001").value_or(""));
  ::unsetenv(kDriverNotes);
  ASSERT_TRUE(learned.known());
  EXPECT_LE(learned.width(clock_.mono()), 20ms);
  expectGoodShot(1);
}

}  // namespace
}  // namespace patina::devices::gphoto2
