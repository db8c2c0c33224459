// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/pipeline_camera.h"

#include <gmock/gmock.h>

#include "tests/devices/libcamera/fake_pipeline.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace patina::devices::libcamera;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class PipelineCameraTest : public ::testing::Test {
 protected:
  void make(std::map<std::string, std::string> values = {}) {
    CameraSpec spec;
    spec.id = "cam0";
    spec.serial = "/base/imx477";
    spec.settings = std::move(values);
    camera_ = std::make_unique<PipelineCamera>(spec, readCameraSettings(spec, "rig.toml"),
                                               makeFakePipeline(sensor_, clock_), clock_);
  }
  void open(std::map<std::string, std::string> values = {}) {
    make(std::move(values));
    ASSERT_THAT(camera_->recover(Rung::kReopen), IsOk());
  }
  static Exposure of(Nanoseconds time, double iso = 100) {
    Exposure exposure;
    exposure.time = time;
    exposure.iso = Iso{iso};
    return exposure;
  }
  Result<std::vector<RawFrame>> shoot(std::uint64_t sequence, Nanoseconds patience = 10s) {
    const auto ticket = camera_->trigger({"shot" + std::to_string(sequence), sequence});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return camera_->collect(*ticket, clock_.mono() + patience);
  }

  VirtualClock clock_{utcFromNs(1'700'000'000'000'000'000)};
  FakeSensor sensor_ = smallSensor();
  std::unique_ptr<PipelineCamera> camera_;
};

TEST_F(PipelineCameraTest, WaitsForTheFrameThatHasWhatWasAsked) {
  open({{"warm_up_frames", "1"}});
  sensor_.depth = 5;
  ASSERT_THAT(camera_->configure(of(10ms, 400)), IsOk());
  ASSERT_THAT(camera_->configure(of(20ms, 200)), IsOk());
  const int before = sensor_.frames;
  const auto frames = shoot(1);
  ASSERT_THAT(frames, IsOk());
  // As many as the pipeline is deep still had the settings of the reading back before.
  EXPECT_EQ(decodePicture(frames->at(0).bytes).linear.size(), (SizePx{4, 2}));
  EXPECT_EQ(sensor_.frames - before, 2);
  ASSERT_THAT(camera_->configure(of(10ms, 400)), IsOk());
  const int again = sensor_.frames;
  ASSERT_THAT(shoot(2), IsOk());
  EXPECT_EQ(sensor_.frames - again, 6);
}

TEST_F(PipelineCameraTest, ConfigureAnswersWhatTheSensorSays) {
  open();
  sensor_.exposure_error = 0.004;
  const auto applied = camera_->configure(of(10ms, 300));
  ASSERT_THAT(applied, IsOk());
  EXPECT_EQ(applied->exposure.time, 10040us);
  EXPECT_DOUBLE_EQ(applied->exposure.iso.value, 300);
  EXPECT_FALSE(sensor_.streaming);
}

TEST_F(PipelineCameraTest, ReadsASettingBackOnceUntilItIsRecovered) {
  open();
  for (int i = 0; i < 3; ++i) ASSERT_THAT(camera_->configure(of(10ms)), IsOk());
  EXPECT_EQ(sensor_.starts, 1);
  ASSERT_THAT(camera_->recover(Rung::kRetry), IsOk());
  ASSERT_THAT(camera_->configure(of(10ms)), IsOk());
  EXPECT_EQ(sensor_.starts, 2);
}

TEST_F(PipelineCameraTest, ASettingThatDoesNotStickIsRefusedNamingAskedAndGot) {
  open();
  sensor_.exposure_max = 33ms;
  const auto applied = camera_->configure(of(100ms));
  ASSERT_THAT(applied, Fails(Errc::kRefused));
  EXPECT_THAT(applied.error().what, HasSubstr("asked 0.1 s, got 0.033 s"));
  EXPECT_THAT(applied.error().what, HasSubstr("cam0"));
  EXPECT_FALSE(sensor_.streaming);
}

TEST_F(PipelineCameraTest, ALongExposureIsReadBackWithItsShot) {
  open();
  sensor_.frame_time = 5s;
  sensor_.exposure_max = 3s;
  EXPECT_THAT(camera_->configure(of(5s)), IsOk());
  EXPECT_EQ(sensor_.starts, 0);
  EXPECT_THAT(shoot(1, 1000s), Fails(Errc::kRefused));
}

TEST_F(PipelineCameraTest, AFactorOnTopIsNotThePictureThatWasAsked) {
  open();
  sensor_.digital_gain = 1.5;
  const auto applied = camera_->configure(of(10ms));
  ASSERT_THAT(applied, Fails(Errc::kRefused));
  EXPECT_THAT(applied.error().what, HasSubstr("digital gain"));
}

TEST_F(PipelineCameraTest, ACameraThatDoesNotSayItsExposureIsUnsupported) {
  open();
  sensor_.says_exposure = false;
  const auto applied = camera_->configure(of(10ms));
  ASSERT_THAT(applied, Fails(Errc::kUnsupported));
  EXPECT_THAT(applied.error().what, HasSubstr("v4l2"));
}

TEST_F(PipelineCameraTest, WithoutControlOfTheExposureTheRigFileSaysIt) {
  sensor_.camera.has_exposure = sensor_.camera.has_gain = false;
  open();
  const auto unsaid = camera_->configure(of(10ms));
  ASSERT_THAT(unsaid, Fails(Errc::kUnsupported));
  EXPECT_THAT(unsaid.error().what, HasSubstr("fixed_exposure"));

  open({{"fixed_exposure", "1/50"}});
  EXPECT_EQ(camera_->caps().exposure_max, 20ms);
  EXPECT_THAT(camera_->configure(of(10ms)), Fails(Errc::kRefused));
  const auto applied = camera_->configure(of(20ms, 800));
  ASSERT_THAT(applied, IsOk());
  EXPECT_EQ(applied->exposure, of(20ms, 800));
  EXPECT_THAT(shoot(1), IsOk());
}

TEST_F(PipelineCameraTest, StreamsOnlyFromTheTriggerToThePicture) {
  open();
  const auto ticket = camera_->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  EXPECT_TRUE(sensor_.streaming);
  ASSERT_THAT(camera_->collect(*ticket, clock_.mono() + 10s), IsOk());
  EXPECT_FALSE(sensor_.streaming);
}

TEST_F(PipelineCameraTest, TheTimeIsTheMiddleOfTheExposure) {
  open({{"warm_up_frames", "0"}});
  sensor_.depth = 0;
  ASSERT_THAT(camera_->configure(of(20ms)), IsOk());
  const MonoTime began = clock_.mono();
  const auto frames = shoot(1);
  ASSERT_THAT(frames, IsOk());
  EXPECT_NEAR(toSeconds(frames->at(0).mono - began), 0.040, 0.001);
  EXPECT_EQ(frames->at(0).sequence, 1u);
}

TEST_F(PipelineCameraTest, DamagedFramesAreLeftOutAndOnlyThoseAreCorrupt) {
  open({{"warm_up_frames", "0"}});
  ASSERT_THAT(camera_->configure(of(10ms)), IsOk());
  sensor_.damaged_left = 4;
  EXPECT_THAT(shoot(1), IsOk());
  sensor_.damaged_left = 1'000'000;
  EXPECT_THAT(shoot(2), Fails(Errc::kCorrupt));
  sensor_.damaged_left = 0;
  EXPECT_THAT(shoot(3), IsOk());
}

TEST_F(PipelineCameraTest, NoFrameIsATimeoutAtTheDeadlineAndNeedsRecovery) {
  open();
  sensor_.sends = false;
  const auto ticket = camera_->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  const MonoTime deadline = clock_.mono() + 1ms;
  EXPECT_THAT(camera_->collect(*ticket, deadline), Fails(Errc::kTimeout));
  EXPECT_LE(clock_.mono(), deadline);
  EXPECT_THAT(camera_->trigger({"b", 2}), Fails(Errc::kRefused));
  EXPECT_THAT(camera_->poll(), Fails(Errc::kRefused));
  sensor_.sends = true;
  EXPECT_THAT(camera_->recover(Rung::kDrain), IsOk());
  EXPECT_THAT(shoot(3), IsOk());
}

TEST_F(PipelineCameraTest, UnpluggedIsLostUntilItIsReopened) {
  open();
  const auto ticket = camera_->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  sensor_.plugged = false;
  EXPECT_THAT(camera_->collect(*ticket, clock_.mono() + 1s), Fails(Errc::kLost));
  EXPECT_THAT(camera_->configure(of(10ms)), Fails(Errc::kLost));
  EXPECT_THAT(camera_->recover(Rung::kRetry), Fails(Errc::kLost));
  EXPECT_THAT(camera_->recover(Rung::kReopen), Fails(Errc::kLost));
  sensor_.plugged = true;
  EXPECT_THAT(camera_->recover(Rung::kRetry), Fails(Errc::kLost));
  EXPECT_THAT(camera_->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(shoot(2), IsOk());
}

TEST_F(PipelineCameraTest, ReopeningLooksAnewWhereTheLibraryDidNotNotice) {
  make();
  sensor_.must_forget = true;
  EXPECT_THAT(camera_->recover(Rung::kReopen), IsOk());
  EXPECT_EQ(sensor_.forgets, 1);
  EXPECT_EQ(sensor_.opens, 2);
}

TEST_F(PipelineCameraTest, PollNoticesThatItWasUnplugged) {
  open();
  EXPECT_THAT(camera_->poll(), IsOk());
  sensor_.plugged = false;
  EXPECT_THAT(camera_->poll(), Fails(Errc::kLost));
}

TEST_F(PipelineCameraTest, EachStateAllowsItsOwnCalls) {
  make();
  EXPECT_THAT(camera_->trigger({"a", 1}), Fails(Errc::kRefused));
  EXPECT_THAT(camera_->configure(of(10ms)), Fails(Errc::kRefused));
  EXPECT_THAT(camera_->release(RawFrame{}), Fails(Errc::kRefused));
  ASSERT_THAT(camera_->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(camera_->collect(Ticket{}, clock_.mono() + 1s), Fails(Errc::kRefused));
  const auto ticket = camera_->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  EXPECT_THAT(camera_->trigger({"b", 2}), Fails(Errc::kRefused));
  Ticket foreign = *ticket;
  foreign.sequence = 9;
  EXPECT_THAT(camera_->collect(foreign, clock_.mono() + 1s), Fails(Errc::kRefused));
  EXPECT_THAT(camera_->collect(*ticket, clock_.mono() + 1s), IsOk());
  EXPECT_THAT(camera_->collect(*ticket, clock_.mono() + 1s), Fails(Errc::kRefused));
}

TEST_F(PipelineCameraTest, RecoveryDropsTheArmedShot) {
  open();
  const auto ticket = camera_->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  for (const Rung rung : {Rung::kRetry, Rung::kDrain, Rung::kReopen, Rung::kReset}) {
    EXPECT_THAT(camera_->recover(rung), IsOk()) << name(rung);
    EXPECT_FALSE(sensor_.streaming);
    EXPECT_THAT(camera_->collect(*ticket, clock_.mono() + 1s), Fails(Errc::kRefused));
  }
  EXPECT_EQ(sensor_.forgets, 1);
  EXPECT_THAT(camera_->recover(Rung::kPowerCycle), Fails(Errc::kUnsupported));
  EXPECT_THAT(shoot(2), IsOk());
}

TEST_F(PipelineCameraTest, ACameraInUseIsBusyAndStaysClosed) {
  make();
  sensor_.open_error = Errc::kBusy;
  EXPECT_THAT(camera_->recover(Rung::kReopen), Fails(Errc::kBusy));
  EXPECT_THAT(camera_->trigger({"a", 1}), Fails(Errc::kRefused));
  sensor_.open_error.reset();
  EXPECT_THAT(camera_->recover(Rung::kReopen), IsOk());
}

TEST_F(PipelineCameraTest, FocusOnACameraThatCannotIsUnsupported) {
  sensor_.camera.has_focus = false;
  open({{"focus_dioptres", "2.5"}});
  EXPECT_THAT(camera_->configure(of(10ms)), Fails(Errc::kUnsupported));
}

TEST_F(PipelineCameraTest, CapsComeFromTheRigFileAlone) {
  make({{"format", "dng"}, {"width_px", "4056"}, {"height_px", "3040"}, {"exposure_max", "20s"}});
  const CameraCaps& caps = camera_->caps();
  EXPECT_EQ(sensor_.opens, 0);
  EXPECT_EQ(caps.id, "cam0");
  EXPECT_EQ(caps.serial, "/base/imx477");
  EXPECT_EQ(caps.size, (SizePx{4056, 3040}));
  EXPECT_EQ(caps.bits, 0);
  EXPECT_EQ(caps.extensions, std::vector<std::string>{"dng"});
  EXPECT_EQ(caps.exposure_max, 20s);
  EXPECT_GT(caps.bytes_a_shot, 0);
}

}  // namespace
}  // namespace patina::testing
