// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/v4l2_camera.h"

#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class V4l2Camera : public V4l2Fixture {
 protected:
  void SetUp() override {
    V4l2Fixture::SetUp();
    if (IsSkipped()) return;
    webcam.formats[0].sizes = {{32, 24}};
    testbed().plugIn(webcam, 0, 1);
  }
  std::unique_ptr<v4l2::V4l2Camera> opened(std::map<std::string, std::string> settings = {}) {
    auto camera = make(std::move(settings));
    EXPECT_THAT(camera->recover(Rung::kReopen), IsOk());
    return camera;
  }
  // Every frame says in its luma when its light began: milliseconds since the test's start.
  void paintTimes() {
    const MonoTime start = clock.mono();
    webcam.paint = [this, start](const SimulatedFrame& frame) {
      std::vector<std::byte> bytes(frame.row_bytes * 24, std::byte{128});
      const auto ms = (frame.began - start) / 1ms;
      for (std::size_t i = 0; i < bytes.size(); i += 4) {
        bytes[i] = static_cast<std::byte>(16 + ms / 100);
        bytes[i + 2] = static_cast<std::byte>(16 + ms % 100);
      }
      last_began = frame.began;
      began_by_luma[{16 + static_cast<int>(ms / 100), 16 + static_cast<int>(ms % 100)}] =
          frame.began;
      return bytes;
    };
  }
  MonoTime last_began;
  std::map<std::pair<int, int>, MonoTime> began_by_luma;
};

TEST_F(V4l2Camera, NeverHandsOverAFrameWhoseLightBeganBeforeTheTrigger) {
  for (const std::uint32_t source : {V4L2_BUF_FLAG_TSTAMP_SRC_SOE, V4L2_BUF_FLAG_TSTAMP_SRC_EOF})
    for (const int pipeline : {0, 1}) {
      webcam.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | source;
      webcam.pipeline_frames = pipeline;
      auto camera = opened();
      ASSERT_THAT(camera->configure({20ms}), IsOk());
      paintTimes();
      for (int i = 0; i < 20; ++i) {
        clock.advance(i * 7ms);
        const auto frame = shoot(*camera);
        ASSERT_THAT(frame, IsOk());
        EXPECT_GE(last_began, triggered) << source << " pipeline " << pipeline;
        EXPECT_GE(frame->mono, triggered);
        EXPECT_LE(frame->mono, clock.mono());
      }
    }
}

TEST_F(V4l2Camera, KeepsThePictureAsItsFormatSays) {
  auto camera = opened();
  const auto frame = shoot(*camera);
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(frame->ext, "png");
  EXPECT_EQ(readPictureHeader(frame->bytes).size, (SizePx{32, 24}));
  EXPECT_EQ(frame->sequence, 1u);
  EXPECT_EQ(frame->utc - clock.utc(), frame->mono - clock.mono());
}

TEST_F(V4l2Camera, TheExposureIsReadBackInTheCamerasOwnSteps) {
  auto camera = opened();
  const auto applied = camera->configure({Nanoseconds{16'666'667}});
  ASSERT_THAT(applied, IsOk());
  EXPECT_EQ(applied->exposure.time, 16'700us);
  EXPECT_EQ(webcam.controls.value(V4L2_CID_EXPOSURE_ABSOLUTE, 0), 167);
}

TEST_F(V4l2Camera, AnExposureBetweenTwoStepsIsRefusedWithBoth) {
  auto camera = opened();
  const auto applied = camera->configure({150us});
  ASSERT_THAT(applied, Fails(Errc::kRefused));
  EXPECT_THAT(applied.error().what, HasSubstr("1/10000 and 1/5000"));
}

TEST_F(V4l2Camera, ASettingThatDoesNotStickIsRefusedWithAskedAndGot) {
  auto camera = opened();
  webcam.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).keeps_old_value = true;
  const auto applied = camera->configure({20ms});
  ASSERT_THAT(applied, Fails(Errc::kRefused));
  EXPECT_THAT(applied.error().what, HasSubstr("asked for 200, the camera says 157"));
}

TEST_F(V4l2Camera, ASettingThatChangesByItselfIsAnErrorAndNeverAFrame) {
  auto camera = opened({{"gain", "40"}});
  webcam.after_frame = [this] { webcam.controls.at(V4L2_CID_GAIN).value = 90; };
  const auto frame = shoot(*camera);
  ASSERT_THAT(frame, Fails(Errc::kRefused));
  EXPECT_THAT(frame.error().what, HasSubstr("'Gain' changed by itself from 40 to 90"));
  webcam.after_frame = nullptr;
  ASSERT_THAT(camera->configure({20ms}), IsOk());
  EXPECT_EQ(webcam.controls.value(V4L2_CID_GAIN, 0), 40);
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, AfterASettingChangedTheNextFramesAreNotTaken) {
  auto camera = opened({{"settle_frames", "4"}});
  ASSERT_THAT(shoot(*camera), IsOk());
  ASSERT_THAT(camera->configure({10ms}), IsOk());
  const std::uint32_t before = webcam.framesHandedOver();
  ASSERT_THAT(shoot(*camera), IsOk());
  EXPECT_GT(webcam.framesHandedOver() - before, 4u);
}

TEST_F(V4l2Camera, FramesThatNeverCameAreCountedAndTold) {
  auto camera = opened({{"warm_up_frames", "0"}, {"settle_frames", "0"}});
  ASSERT_THAT(shoot(*camera), IsOk());
  EXPECT_TRUE(camera->poll()->empty());
  // Buffers are taken in turn at once after the trigger, so those numbers lie in the shot.
  for (std::uint32_t n = 0; n < 200; ++n)
    if (n % 2 == 1) webcam.lost.insert(n);
  ASSERT_THAT(shoot(*camera), IsOk());
  const auto events = camera->poll();
  ASSERT_THAT(events, IsOk());
  ASSERT_EQ(events->size(), 1u);
  EXPECT_THAT(events->at(0).what, HasSubstr("frames were lost"));
}

TEST_F(V4l2Camera, ADamagedFrameIsCorruptAndTheNextShotIsGood) {
  auto camera = opened();
  ASSERT_THAT(shoot(*camera), IsOk());
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.flags |= V4L2_BUF_FLAG_ERROR; };
  EXPECT_THAT(shoot(*camera), Fails(Errc::kCorrupt));
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.bytesused -= 64; };
  EXPECT_THAT(shoot(*camera), Fails(Errc::kCorrupt));
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.bytesused = 0; };
  EXPECT_THAT(shoot(*camera), Fails(Errc::kCorrupt));
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.bytesused = 1 << 30; };
  EXPECT_THAT(shoot(*camera), Fails(Errc::kCorrupt));
  webcam.spoil = nullptr;
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, AJpegCutShortIsCorrupt) {
  auto camera = opened({{"format", "mjpeg"}, {"size", "64x48"}});
  const auto whole = shoot(*camera);
  ASSERT_THAT(whole, IsOk());
  EXPECT_EQ(whole->ext, "jpg");
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.bytesused /= 2; };
  EXPECT_THAT(shoot(*camera), Fails(Errc::kCorrupt));
}

TEST_F(V4l2Camera, StampsOfAnotherClockAreRefused) {
  webcam.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  auto camera = opened();
  const auto frame = shoot(*camera);
  ASSERT_THAT(frame, Fails(Errc::kUnsupported));
  EXPECT_THAT(frame.error().what, HasSubstr("CLOCK_MONOTONIC"));
}

TEST_F(V4l2Camera, NoFrameByTheDeadlineIsATimeoutThatADrainRecovers) {
  auto camera = opened();
  webcam.silent = true;
  const MonoTime before = clock.mono();
  EXPECT_THAT(shoot(*camera), Fails(Errc::kTimeout));
  EXPECT_EQ(clock.mono(), before + 5s);
  EXPECT_THAT(camera->configure({20ms}), Fails(Errc::kRefused));
  webcam.silent = false;
  ASSERT_THAT(camera->recover(Rung::kDrain), IsOk());
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, UnpluggedIsLostUntilItIsThereAgainUnderAnotherNumber) {
  auto camera = opened({{"gain", "40"}});
  ASSERT_THAT(camera->configure({20ms}), IsOk());
  ASSERT_THAT(shoot(*camera), IsOk());
  testbed().pullOut(webcam);
  EXPECT_THAT(shoot(*camera), Fails(Errc::kLost));
  EXPECT_THAT(camera->poll(), Fails(Errc::kLost));
  const auto absent = camera->recover(Rung::kReopen);
  ASSERT_THAT(absent, Fails(Errc::kLost));
  EXPECT_THAT(absent.error().what, HasSubstr("serial SIM0001 is not attached; there are: none"));
  testbed().plugIn(webcam, 3, 1);
  EXPECT_EQ(webcam.controls.value(V4L2_CID_GAIN, 0), 10);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  EXPECT_EQ(webcam.controls.value(V4L2_CID_GAIN, 0), 40);
  EXPECT_EQ(webcam.controls.value(V4L2_CID_EXPOSURE_ABSOLUTE, 0), 200);
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, AnUnplugIsSeenBetweenTheShots) {
  auto camera = opened();
  EXPECT_THAT(camera->poll(), IsOk());
  testbed().pullOut(webcam);
  EXPECT_THAT(camera->poll(), Fails(Errc::kLost));
}

TEST_F(V4l2Camera, AnotherCameraInTheSamePortDoesNotTakeOver) {
  CameraSpec by_path = spec({{"device", V4l2Testbed::byPath(1)}});
  by_path.serial.clear();
  auto camera = make(by_path);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  testbed().pullOut(webcam);
  SimulatedCamera other(clock);
  other.serial = "SIM0002";
  testbed().plugIn(other, 0, 1);
  const auto again = camera->recover(Rung::kReopen);
  ASSERT_THAT(again, Fails(Errc::kRefused));
  EXPECT_THAT(again.error().what, HasSubstr("another camera is attached"));
  testbed().pullOut(other);
}

TEST_F(V4l2Camera, ASleepOfTheMachineMakesNoOldFrameNew) {
  auto camera = opened();
  ASSERT_THAT(shoot(*camera), IsOk());
  // The machine sleeps between trigger and frame: mono() jumps, the stamps do not.
  const auto ticket = camera->trigger({"asleep", 90});
  ASSERT_THAT(ticket, IsOk());
  webcam.after_frame = [this] {
    if (slept > 0s) return;
    slept = 10s;
    clock.suspend(slept);
  };
  webcam.spoil = [this](v4l2_buffer& buffer) { buffer.timestamp.tv_sec -= slept / 1s; };
  EXPECT_THAT(camera->collect(*ticket, soon(30s)), Fails(Errc::kCorrupt));
}

TEST_F(V4l2Camera, StampsAreOfTheKernelsClockWhereTheMachineHasSlept) {
  slept = 1h;
  clock.advance(2h);
  // What the kernel calls now lies an hour before mono().
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.timestamp.tv_sec -= 3600; };
  auto camera = opened();
  const auto frame = shoot(*camera);
  ASSERT_THAT(frame, IsOk());
  EXPECT_GE(frame->mono, triggered);
  EXPECT_LE(frame->mono, clock.mono());
}

TEST_F(V4l2Camera, AStampOfTheFutureMakesNoPictureOfIt) {
  webcam.spoil = [](v4l2_buffer& buffer) { buffer.timestamp.tv_sec += 1; };
  auto camera = opened();
  paintTimes();
  for (int i = 0; i < 10; ++i) {
    clock.advance(i * 7ms);
    const auto frame = shoot(*camera);
    ASSERT_THAT(frame, IsOk());
    EXPECT_LE(frame->mono, clock.mono());
  }
}

TEST_F(V4l2Camera, TheStreamStopsBetweenShotsWhereTheRigSaysSo) {
  auto camera = opened({{"between", "stop"}});
  EXPECT_FALSE(webcam.streaming());
  ASSERT_THAT(shoot(*camera), IsOk());
  EXPECT_FALSE(webcam.streaming());
  auto another = opened();
  EXPECT_TRUE(webcam.streaming());
}

// What is left of a reset is opening: without it a camera that was away would stay away.
TEST_F(V4l2Camera, AResetOpensItAndPowerIsNotThisDrivers) {
  auto camera = opened();
  EXPECT_THAT(camera->recover(Rung::kPowerCycle), Fails(Errc::kUnsupported));
  EXPECT_THAT(shoot(*camera), IsOk());
  testbed().pullOut(webcam);
  EXPECT_THAT(shoot(*camera), Fails(Errc::kLost));
  testbed().plugIn(webcam, 1, 1);
  EXPECT_THAT(camera->recover(Rung::kReset), IsOk());
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, ADriverThatFailsToStartIsAnErrorAndOpensTheNextTime) {
  auto camera = make();
  webcam.fails[VIDIOC_STREAMON] = EINVAL;
  EXPECT_THAT(camera->recover(Rung::kReopen), Fails(Errc::kRefused));
  webcam.fails = {{VIDIOC_REQBUFS, EBUSY}};
  const auto busy = camera->recover(Rung::kReopen);
  ASSERT_THAT(busy, Fails(Errc::kBusy));
  EXPECT_THAT(busy.error().what, HasSubstr("another program uses the camera"));
  webcam.fails.clear();
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  webcam.fails = {{VIDIOC_DQBUF, EIO}};
  EXPECT_THAT(shoot(*camera), Fails(Errc::kLost));
  webcam.fails.clear();
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(shoot(*camera), IsOk());
}

TEST_F(V4l2Camera, WithoutAControlOfTheExposureTheRigMustSayWhatItIs) {
  webcam.controls.remove(V4L2_CID_EXPOSURE_ABSOLUTE);
  auto camera = opened();
  const auto unknown = camera->configure({20ms});
  ASSERT_THAT(unknown, Fails(Errc::kUnsupported));
  EXPECT_THAT(unknown.error().what, HasSubstr("fixed_exposure"));
  camera.reset();
  auto fixed = opened({{"fixed_exposure", "1/50"}});
  EXPECT_THAT(fixed->configure({20ms}), IsOk());
  EXPECT_THAT(fixed->configure({10ms}), Fails(Errc::kRefused));
  EXPECT_THAT(shoot(*fixed), IsOk());
}

}  // namespace
}  // namespace patina::testing
