// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/stream.h"

#include "devices/v4l2/frame_format.h"
#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

class Stream : public V4l2Fixture {
 protected:
  void SetUp() override {
    V4l2Fixture::SetUp();
    if (IsSkipped()) return;
    testbed().plugIn(webcam, 0, 1);
    node_.emplace(std::move(*v4l2::Node::open("/dev/video0", "v4l2 'cam0'")));
    const auto settings = v4l2::readCameraSettings(spec({{"size", "32x24"}}), "rig.toml");
    ASSERT_THAT(v4l2::setFrameFormat(*node_, settings), IsOk());
  }
  Result<std::unique_ptr<v4l2::Stream>> start(int buffers = 4) {
    return v4l2::Stream::start(*node_, clock, buffers);
  }
  std::optional<v4l2::Node> node_;
};

TEST_F(Stream, FramesComeInOrderWithTheirStampAndBytes) {
  auto stream = start();
  ASSERT_THAT(stream, IsOk());
  for (std::uint32_t n = 0; n < 10; ++n) {
    const auto filled = (*stream)->next(clock.mono() + 1s);
    ASSERT_THAT(filled, IsOk());
    ASSERT_TRUE(*filled);
    EXPECT_EQ((*filled)->sequence, n);
    EXPECT_EQ((*filled)->bytes.size(), 32u * 24 * 2);
    EXPECT_TRUE((*filled)->stamp_is_monotonic);
    EXPECT_TRUE((*filled)->stamp.start_of_frame);
    ASSERT_THAT((*stream)->giveBack(**filled), IsOk());
  }
}

TEST_F(Stream, WithoutAFrameItWaitsToTheDeadlineAndNotLonger) {
  webcam.silent = true;
  auto stream = start();
  const MonoTime deadline = clock.mono() + 3s;
  const auto filled = (*stream)->next(deadline);
  ASSERT_THAT(filled, IsOk());
  EXPECT_FALSE(*filled);
  EXPECT_EQ(clock.mono(), deadline);
}

TEST_F(Stream, ADrainGivesAllThatIsFilledBackToTheDriver) {
  auto stream = start(3);
  clock.advance(200ms);
  EXPECT_EQ(*(*stream)->drain(), 3);
  EXPECT_EQ(*(*stream)->drain(), 0);
  const auto filled = (*stream)->next(clock.mono() + 1s);
  ASSERT_TRUE(*filled);
  EXPECT_GE((*filled)->sequence, 12u);  // 15.7 ms each: those between found no buffer
}

TEST_F(Stream, ItsEndStopsTheCameraAndFreesTheBuffers) {
  {
    auto stream = start();
    EXPECT_TRUE(webcam.streaming());
  }
  EXPECT_FALSE(webcam.streaming());
  EXPECT_THAT(start(), IsOk());
}

TEST_F(Stream, MoreBytesThanTheBufferHoldsAreNotRead) {
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.bytesused = 1 << 30; };
  auto stream = start();
  const auto filled = (*stream)->next(clock.mono() + 1s);
  ASSERT_TRUE(*filled);
  EXPECT_EQ((*filled)->bytes_used, 1u << 30);
  EXPECT_EQ((*filled)->bytes.size(), 32u * 24 * 2);
}

TEST_F(Stream, ABufferThatIsNotThereIsAnError) {
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.index = 30; };
  auto stream = start();
  EXPECT_THAT((*stream)->next(clock.mono() + 1s), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::testing
