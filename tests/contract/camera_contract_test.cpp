// SPDX-License-Identifier: GPL-3.0-or-later
// What every camera owes its session. For each state first the calls that must fail, then those
// that must pass: a call in a wrong state changes nothing.
#include <gmock/gmock.h>

#include "devices/camera.h"
#include "tests/contract/backends.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::AnyOf;
using ::testing::Contains;

class CameraContract : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    made_ = GetParam().make();
    camera_ = made_.rig.cameras.at(0).get();
  }
  Camera& camera() { return *camera_; }
  Clock& clock() { return made_.real ? *made_.real : static_cast<Clock&>(*made_.clock); }
  Nanoseconds jitter() const { return made_.jitter; }
  Nanoseconds lag() const { return made_.lag; }

  void open() { ASSERT_THAT(camera().recover(Rung::kReopen), IsOk()); }
  MonoTime enough() { return clock().mono() + Exposure{}.time + camera().caps().cycle + 10s; }
  static ShotRequest request(std::uint64_t sequence) {
    return {"run/1/cam0/off/0/" + std::to_string(sequence), sequence};
  }
  // The pictures of one shot that must succeed.
  std::vector<RawFrame> shoot(std::uint64_t sequence) {
    const Result<Ticket> ticket = camera().trigger(request(sequence));
    EXPECT_THAT(ticket, IsOk());
    if (!ticket) return {};
    auto frames = camera().collect(*ticket, enough());
    EXPECT_THAT(frames, IsOk());
    return frames ? *frames : std::vector<RawFrame>{};
  }
  void expectNoShotPossible(Errc code) {
    EXPECT_THAT(camera().configure(Exposure{}), Fails(code));
    EXPECT_THAT(camera().trigger(request(99)), Fails(code));
    EXPECT_THAT(camera().poll(), Fails(code));
    EXPECT_THAT(camera().release(RawFrame{}), Fails(code));
  }

 private:
  RigUnderTest made_;
  Camera* camera_ = nullptr;
};

TEST_P(CameraContract, KnowsWhatItIsBeforeItIsOpened) {
  const CameraCaps& caps = camera().caps();
  EXPECT_EQ(caps.id, "cam0");
  EXPECT_FALSE(caps.model.empty());
  EXPECT_GE(caps.size.width, 0);  // 0x0 and 0 bits: learned from the first picture
  EXPECT_EQ(caps.size.width > 0, caps.size.height > 0);
  EXPECT_GE(caps.bits, 0);
  EXPECT_FALSE(caps.extensions.empty());
  EXPECT_GT(caps.exposure_min, 0ns);
  EXPECT_LE(caps.exposure_min, caps.exposure_max);
  EXPECT_GT(caps.cycle, 0ns);
  EXPECT_GT(caps.bytes_a_shot, 0);
}

TEST_P(CameraContract, ClosedAllowsNothingButRecover) {
  expectNoShotPossible(Errc::kRefused);
  EXPECT_THAT(camera().collect(Ticket{}, enough()), Fails(Errc::kRefused));
  open();
  EXPECT_FALSE(shoot(1).empty());
}

TEST_P(CameraContract, ReadyRefusesCollectAndAllowsTheRest) {
  open();
  EXPECT_THAT(camera().collect(Ticket{}, enough()), Fails(Errc::kRefused));
  EXPECT_THAT(camera().configure(Exposure{}), IsOk());
  EXPECT_THAT(camera().poll(), IsOk());
  EXPECT_THAT(camera().recover(Rung::kRetry), IsOk());
  EXPECT_FALSE(shoot(1).empty());
}

TEST_P(CameraContract, ArmedAllowsCollectAndNothingElseChangesIt) {
  open();
  const Result<Ticket> ticket = camera().trigger(request(1));
  ASSERT_THAT(ticket, IsOk());
  expectNoShotPossible(Errc::kRefused);
  Ticket foreign = *ticket;
  foreign.key += "x";
  EXPECT_THAT(camera().collect(foreign, enough()), Fails(Errc::kRefused));
  EXPECT_THAT(camera().collect(*ticket, enough()), IsOk());
}

TEST_P(CameraContract, ATicketIsCollectedOnce) {
  open();
  const Result<Ticket> ticket = camera().trigger(request(1));
  ASSERT_THAT(ticket, IsOk());
  ASSERT_THAT(camera().collect(*ticket, enough()), IsOk());
  EXPECT_THAT(camera().collect(*ticket, enough()), Fails(Errc::kRefused));
  EXPECT_FALSE(shoot(2).empty());
}

TEST_P(CameraContract, TheTicketNamesTheAttemptAndWhenItBegan) {
  open();
  const MonoTime mono = clock().mono();
  const UtcTime utc = clock().utc();
  const Result<Ticket> ticket = camera().trigger(request(7));
  ASSERT_THAT(ticket, IsOk());
  EXPECT_EQ(ticket->key, request(7).key);
  EXPECT_EQ(ticket->sequence, 7u);
  EXPECT_GE(ticket->began_mono, mono);
  EXPECT_LE(ticket->began_mono, clock().mono());
  const Nanoseconds apart = (ticket->began_utc - utc) - (ticket->began_mono - mono);
  EXPECT_LE(std::chrono::abs(apart), jitter());
}

TEST_P(CameraContract, APictureIsWhatTheCapsPromise) {
  open();
  const MonoTime before = clock().mono();
  const std::vector<RawFrame> frames = shoot(1);
  const CameraCaps& caps = camera().caps();
  ASSERT_EQ(frames.size(), caps.extensions.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RawFrame& frame = frames[i];
    EXPECT_EQ(frame.file_index, static_cast<int>(i));
    EXPECT_EQ(frame.ext, caps.extensions[i]);
    EXPECT_EQ(frame.sequence, 1u);
    EXPECT_EQ(extensionOf(sniffFormat(frame.bytes)), frame.ext);
    if (caps.size.width > 0) {
      EXPECT_EQ(readPictureHeader(frame.bytes).size, caps.size);
    }
    EXPECT_NO_THROW(decodePicture(frame.bytes));
    if (frame.declared_bytes) {
      EXPECT_EQ(*frame.declared_bytes, static_cast<std::int64_t>(frame.bytes.size()));
    }
    EXPECT_GE(frame.mono, before);
    EXPECT_LE(frame.mono, clock().mono());
  }
}

TEST_P(CameraContract, TwoShotsAreTwoPictures) {
  open();
  const std::vector<RawFrame> first = shoot(1), second = shoot(2);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_NE(first[i].bytes, second[i].bytes);
    EXPECT_EQ(second[i].sequence, 2u);
    EXPECT_GT(second[i].mono, first[i].mono);
  }
}

TEST_P(CameraContract, ADeadlineIsKeptAndALateShotIsRecovered) {
  open();
  const Result<Ticket> ticket = camera().trigger(request(1));
  ASSERT_THAT(ticket, IsOk());
  const MonoTime deadline = clock().mono() + 1ms;
  EXPECT_THAT(camera().collect(*ticket, deadline), Fails(Errc::kTimeout));
  EXPECT_LE(clock().mono(), deadline + jitter());
  expectNoShotPossible(Errc::kRefused);
  open();
  EXPECT_THAT(camera().collect(*ticket, enough()), Fails(Errc::kRefused));
  EXPECT_EQ(shoot(2).at(0).sequence, 2u);
}

TEST_P(CameraContract, ADeadlineInThePastIsATimeoutAtOnce) {
  open();
  const Result<Ticket> ticket = camera().trigger(request(1));
  ASSERT_THAT(ticket, IsOk());
  const MonoTime now = clock().mono();
  EXPECT_THAT(camera().collect(*ticket, now - 1h), Fails(Errc::kTimeout));
  EXPECT_LE(clock().mono() - now, jitter());
}

TEST_P(CameraContract, EveryRungRecoversAReadyCameraAnyNumberOfTimes) {
  open();
  for (const Rung rung : {Rung::kRetry, Rung::kDrain, Rung::kReopen}) {
    EXPECT_THAT(camera().recover(rung), IsOk()) << name(rung);
    EXPECT_THAT(camera().recover(rung), IsOk()) << name(rung);
  }
  // What a driver cannot do itself it says, and changes nothing.
  for (const Rung rung : {Rung::kReset, Rung::kPowerCycle}) {
    for (int i = 0; i < 2; ++i) {
      const Result<void> done = camera().recover(rung);
      EXPECT_TRUE(done || done.error().code == Errc::kUnsupported) << name(rung);
    }
  }
  EXPECT_FALSE(shoot(1).empty());
}

TEST_P(CameraContract, RecoverDropsAnArmedShotAndItsPicture) {
  open();
  const Result<Ticket> dropped = camera().trigger(request(1));
  ASSERT_THAT(dropped, IsOk());
  open();
  EXPECT_THAT(camera().collect(*dropped, enough()), Fails(Errc::kRefused));
  for (const RawFrame& frame : shoot(2)) EXPECT_EQ(frame.sequence, 2u);
}

TEST_P(CameraContract, ConfigureSaysWhatTheHardwareDidAndNeverAdjustsInSilence) {
  open();
  const CameraCaps& caps = camera().caps();
  Exposure exposure;
  exposure.time = std::min(caps.exposure_min * 3, caps.exposure_max);
  const Result<Applied> applied = camera().configure(exposure);
  ASSERT_THAT(applied, IsOk());
  EXPECT_GE(applied->exposure.time, caps.exposure_min);
  EXPECT_LE(applied->exposure.time, caps.exposure_max);
  EXPECT_EQ(camera().configure(exposure)->exposure, applied->exposure);
}

TEST_P(CameraContract, ASettingItCannotDoIsRefusedAndTheOldOneStays) {
  open();
  Exposure kept;
  kept.time =
      std::clamp<Nanoseconds>(20ms, camera().caps().exposure_min, camera().caps().exposure_max);
  ASSERT_THAT(camera().configure(kept), IsOk());
  std::vector<Exposure> impossible(5, kept);
  impossible[0].time = camera().caps().exposure_max + 1s;
  impossible[1].time = camera().caps().exposure_min - 1ns;
  impossible[2].time = -1s;
  impossible[3].iso = Iso{-100};
  impossible[4].f_number = FNumber{0};
  for (const Exposure& exposure : impossible) {
    const Result<Applied> answer = camera().configure(exposure);
    ASSERT_FALSE(answer);
    EXPECT_THAT(answer.error().code, AnyOf(Errc::kRefused, Errc::kUnsupported));
  }
  const MonoTime before = clock().mono();
  const std::vector<RawFrame> frames = shoot(1);
  EXPECT_GE(frames.at(0).mono - before, kept.time / 2);
  EXPECT_LE(frames.at(0).mono - before, kept.time / 2 + lag());
}

TEST_P(CameraContract, AReleasedFrameCanBeReleasedAgain) {
  open();
  for (const RawFrame& frame : shoot(1)) {
    EXPECT_THAT(camera().release(frame), IsOk());
    EXPECT_THAT(camera().release(frame), IsOk());
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, CameraContract, ::testing::ValuesIn(bareAndWrappedBackends()),
                         backendName);
INSTANTIATE_TEST_SUITE_P(RealTime, CameraContract, ::testing::ValuesIn(realTimeBackends()),
                         backendName);

}  // namespace
}  // namespace patina::testing
