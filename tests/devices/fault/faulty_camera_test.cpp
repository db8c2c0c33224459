// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <map>

#include "devices/fault/faulty_devices.h"
#include "tests/contract/backends.h"
#include "tests/contract/stub_devices.h"
#include "tests/support/matchers.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

class FaultyCameraTest : public ::testing::Test {
 protected:
  // A stub camera, opened, with one fault; `at` counts from now.
  void plan(FaultKind kind, Nanoseconds at, Nanoseconds duration) {
    Fault fault;
    fault.at = at;
    fault.device = "cam0";
    fault.kind = kind;
    fault.duration = duration;
    FaultPlan plan;
    plan.faults = {fault};
    camera = withFaults(patina::testing::makeStubCamera("cam0", clock), plan, clock.mono(), clock);
    ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  }
  Result<std::vector<RawFrame>> shoot(std::uint64_t sequence) {
    const auto ticket = camera->trigger({std::to_string(sequence), sequence});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return camera->collect(*ticket, clock.mono() + kPatience);
  }
  // What an untroubled camera gives for this sequence number.
  Bytes truth(std::uint64_t sequence) {
    VirtualClock other(kStart);
    auto stub = patina::testing::makeStubCamera("cam0", other);
    (void)stub->recover(Rung::kReopen).has_value();
    const auto ticket = stub->trigger({"x", sequence});
    return stub->collect(*ticket, other.mono() + kPatience)->at(0).bytes;
  }

  static constexpr Nanoseconds kPatience = 12s;
  VirtualClock clock{kStart};
  std::unique_ptr<Camera> camera;
};

TEST_F(FaultyCameraTest, AHungCameraKeepsItsCallerUntilTheDeadline) {
  plan(FaultKind::kHang, 0s, 1min);
  const MonoTime before = clock.mono();
  EXPECT_THAT(shoot(1), Fails(Errc::kTimeout));
  EXPECT_EQ(clock.mono(), before + kPatience);
}

TEST_F(FaultyCameraTest, AHungCameraComesBackByReopenAfterTheFaultIsOver) {
  plan(FaultKind::kHang, 0s, 1min);
  EXPECT_THAT(shoot(1), Fails(Errc::kTimeout));
  EXPECT_THAT(camera->poll(), Fails(Errc::kTimeout));
  EXPECT_THAT(camera->recover(Rung::kPowerCycle), Fails(Errc::kTimeout));
  clock.advance(1min);
  EXPECT_THAT(camera->recover(Rung::kDrain), Fails(Errc::kTimeout));
  EXPECT_THAT(shoot(2), Fails(Errc::kTimeout));
  EXPECT_THAT(camera->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(shoot(3), IsOk());
}

TEST_F(FaultyCameraTest, ABusyCameraIsReadyAgainByItself) {
  plan(FaultKind::kBusy, 0s, 3s);
  EXPECT_THAT(shoot(1), Fails(Errc::kBusy));
  EXPECT_THAT(camera->poll(), IsOk());
  clock.advance(3s);
  EXPECT_THAT(shoot(2), IsOk());
}

TEST_F(FaultyCameraTest, ALostCameraAnswersNothingUntilResetAfterItsReturn) {
  plan(FaultKind::kLost, 1min, 5min);
  EXPECT_THAT(shoot(1), IsOk());
  clock.advance(1min);
  EXPECT_THAT(shoot(2), Fails(Errc::kLost));
  EXPECT_THAT(camera->configure(Exposure{}), Fails(Errc::kLost));
  EXPECT_THAT(camera->poll(), Fails(Errc::kLost));
  EXPECT_THAT(camera->release(RawFrame{}), Fails(Errc::kLost));
  EXPECT_THAT(camera->recover(Rung::kPowerCycle), Fails(Errc::kLost));
  clock.advance(5min);
  EXPECT_THAT(camera->recover(Rung::kReopen), Fails(Errc::kLost));
  EXPECT_THAT(camera->poll(), Fails(Errc::kLost));
  EXPECT_THAT(camera->recover(Rung::kReset), IsOk());
  EXPECT_THAT(shoot(3), IsOk());
}

TEST_F(FaultyCameraTest, ACameraCanBeLostBetweenTriggerAndCollect) {
  plan(FaultKind::kLost, 1s, 0s);
  const auto ticket = camera->trigger({"1", 1});
  ASSERT_THAT(ticket, IsOk());
  clock.advance(2s);
  EXPECT_THAT(camera->collect(*ticket, clock.mono() + 1s), Fails(Errc::kLost));
  EXPECT_THAT(camera->recover(Rung::kReset), IsOk());
  EXPECT_THAT(camera->collect(*ticket, clock.mono() + 1s), Fails(Errc::kRefused));
}

TEST_F(FaultyCameraTest, APartialFileStillClaimsItsWholeLength) {
  plan(FaultKind::kPartialFile, 0s, 0s);
  const auto frames = shoot(1);
  ASSERT_THAT(frames, IsOk());
  const RawFrame& frame = frames->at(0);
  EXPECT_EQ(frame.declared_bytes, static_cast<std::int64_t>(truth(1).size()));
  EXPECT_LT(frame.bytes.size(), truth(1).size());
  EXPECT_TRUE(std::equal(frame.bytes.begin(), frame.bytes.end(), truth(1).begin()));
  EXPECT_EQ(shoot(2)->at(0).bytes, truth(2));
}

TEST_F(FaultyCameraTest, ADuplicateIsTheSameFileTwice) {
  plan(FaultKind::kDuplicate, 0s, 0s);
  const auto frames = shoot(1);
  ASSERT_THAT(frames, IsOk());
  ASSERT_THAT(*frames, SizeIs(2));
  EXPECT_EQ(frames->at(0).bytes, frames->at(1).bytes);
  EXPECT_EQ(frames->at(0).file_index, frames->at(1).file_index);
  EXPECT_THAT(*shoot(2), SizeIs(1));
}

TEST_F(FaultyCameraTest, ALatePictureComesWithTheNextOneUnderItsOldSequence) {
  plan(FaultKind::kLate, 0s, 0s);
  const MonoTime before = clock.mono();
  EXPECT_THAT(shoot(1), Fails(Errc::kTimeout));
  EXPECT_EQ(clock.mono(), before + kPatience);
  EXPECT_THAT(camera->trigger({"2", 2}), Fails(Errc::kRefused));
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  const auto frames = shoot(2);
  ASSERT_THAT(frames, IsOk());
  ASSERT_THAT(*frames, SizeIs(2));
  EXPECT_EQ(frames->at(0).sequence, 1u);
  EXPECT_EQ(frames->at(0).bytes, truth(1));
  EXPECT_EQ(frames->at(1).sequence, 2u);
  EXPECT_EQ(frames->at(1).bytes, truth(2));
  EXPECT_THAT(*shoot(3), SizeIs(1));
}

TEST_F(FaultyCameraTest, APowerCycleForgetsALatePicture) {
  plan(FaultKind::kLate, 0s, 0s);
  EXPECT_THAT(shoot(1), Fails(Errc::kTimeout));
  ASSERT_THAT(camera->recover(Rung::kPowerCycle), IsOk());
  EXPECT_THAT(*shoot(2), SizeIs(1));
}

TEST_F(FaultyCameraTest, AStaleFrameIsTheOldPictureUnderTheNewNumber) {
  plan(FaultKind::kStaleFrame, 0s, 0s);
  EXPECT_EQ(shoot(1)->at(0).bytes, truth(1));  // nothing older to give
  const auto frames = shoot(2);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ(frames->at(0).sequence, 2u);
  EXPECT_EQ(frames->at(0).bytes, truth(1));
  EXPECT_EQ(shoot(3)->at(0).bytes, truth(3));
}

TEST_F(FaultyCameraTest, APictureOfTheWrongSizeDecodesAndHasAnother) {
  plan(FaultKind::kWrongSize, 0s, 0s);
  const auto frames = shoot(1);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ(decodePicture(frames->at(0).bytes).linear.size(), (SizePx{8, 6}));
  EXPECT_EQ(frames->at(0).declared_bytes, static_cast<std::int64_t>(frames->at(0).bytes.size()));
  EXPECT_EQ(decodePicture(shoot(2)->at(0).bytes).linear.size(), (SizePx{16, 12}));
}

TEST_F(FaultyCameraTest, CorruptBytesKeepTheLength) {
  plan(FaultKind::kCorruptBytes, 0s, 0s);
  const Bytes bytes = shoot(1)->at(0).bytes;
  EXPECT_EQ(bytes.size(), truth(1).size());
  EXPECT_NE(bytes, truth(1));
}

TEST_F(FaultyCameraTest, OnlyTheShotsInsideTheFaultsTimeSuffer) {
  plan(FaultKind::kDuplicate, 10min, 10min);
  std::vector<std::size_t> files;
  const MonoTime start = clock.mono();
  for (std::uint64_t k = 0; k < 5; ++k) {
    clock.sleepUntil(start + static_cast<int>(k) * 5min, {});
    files.push_back(shoot(k + 1)->size());
  }
  EXPECT_THAT(files, ElementsAre(1, 1, 2, 2, 1));
}

TEST_F(FaultyCameraTest, ATwinsRawPictureCanHaveTheWrongSizeToo) {
  const auto twin = patina::testing::bareBackends().at(2);
  Fault fault;
  fault.device = "cam0";
  fault.kind = FaultKind::kWrongSize;
  FaultPlan faults;
  faults.faults = {fault};
  auto made = patina::testing::makeWithFaults(twin, faults);
  Camera& cam = *made.rig.cameras.at(0);
  ASSERT_THAT(cam.recover(Rung::kReopen), IsOk());
  const auto frames = cam.collect(*cam.trigger({"1", 1}), made.clock->mono() + 1min);
  ASSERT_THAT(frames, IsOk());
  for (const RawFrame& frame : *frames) {
    EXPECT_EQ(decodePicture(frame.bytes).linear.size(), (SizePx{32, 24})) << frame.ext;
    EXPECT_EQ(extensionOf(sniffFormat(frame.bytes)), frame.ext);
  }
}

}  // namespace
}  // namespace patina::devices
