// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that hangs, in a session on the real clock, where cameras have workers of their own.
// What ends each run is something that happened, never a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "capture/camera_worker.h"
#include "capture/session.h"
#include "processing/image/sha256.h"
#include "tests/capture/fakes.h"
#include "tests/contract/stub_devices.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;

// What the camera handed out for each attempt, by its key.
struct Handed {
  std::mutex mutex;
  std::map<std::string, Sha256> by_key;
};

// Its picture number `hangs_at` waits in collect until the gate opens, and comes all the same.
class HangingCamera final : public Camera {
 public:
  HangingCamera(std::unique_ptr<Camera> camera, int hangs_at, std::shared_ptr<capture::Gate> gate,
                std::shared_ptr<Handed> handed)
      : camera_(std::move(camera)),
        hangs_at_(hangs_at),
        gate_(std::move(gate)),
        handed_(std::move(handed)) {}
  const CameraCaps& caps() const override { return camera_->caps(); }
  Result<Applied> configure(const Exposure& e) override { return camera_->configure(e); }
  Result<Ticket> trigger(const ShotRequest& r) override { return camera_->trigger(r); }
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    if (++pictures_ == hangs_at_) gate_->pass();
    auto frames = camera_->collect(ticket, std::max(deadline, ticket.began_mono + 1s));
    const std::lock_guard lock(handed_->mutex);
    if (frames) handed_->by_key[ticket.key] = sha256(frames->at(0).bytes);
    return frames;
  }
  Result<void> release(const RawFrame& f) override { return camera_->release(f); }
  Result<std::vector<CameraEvent>> poll() override { return camera_->poll(); }
  Result<void> recover(Rung rung) override { return camera_->recover(rung); }

 private:
  std::unique_ptr<Camera> camera_;
  int hangs_at_, pictures_ = 0;
  std::shared_ptr<capture::Gate> gate_;
  std::shared_ptr<Handed> handed_;
};

// cam0 is well; cam1 hangs at its third picture.
class HungCamera : public ::testing::Test {
 protected:
  HungCamera() {
    gate_->close();
    rig_.spec = parseRig(
        "name = \"bench\"\n[[camera]]\nid = \"cam0\"\nbackend = \"stub\"\n"
        "[[camera]]\nid = \"cam1\"\nbackend = \"stub\"\n",
        folder_ / "rig.toml");
    plan_ = capture::parsePlan(
        "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"400ms\"\nduration = \"4min\"\n"
        "[[sweep]]\nlights = [[]]\nexposures = [\"1/100\"]\n"
        "[light_check]\nmode = \"uncontrolled\"\n",
        folder_ / "plan.toml");
    rig_.cameras.push_back(
        std::make_unique<HangingCamera>(makeStubCamera("cam0", clock_), 0, gate_, handed_));
    rig_.cameras.push_back(
        std::make_unique<HangingCamera>(makeStubCamera("cam1", clock_), 3, gate_, handed_));
    options_.folder = folder_ / "archive";
    options_.owner = "test";
  }

  void run() {
    db::Archive archive(options_);
    const auto start = capture::startRun(plan_, rig_.spec, archive, clock_, {});
    run_id_ = start.run_id;
    capture::SessionHooks hooks;
    hooks.stop = stop_.get_token();
    hooks.on_status = [this](const capture::SessionStatus& status) { afterStep(status); };
    summary_ = capture::runSession(plan_, rig_, archive, clock_, start, hooks);
  }
  virtual void afterStep(const capture::SessionStatus& status) = 0;

  // Every frame lies in the row of the attempt that it was handed out for.
  void expectNothingMixedUp(int at_least) {
    const db::ArchiveReader reader(options_.folder);
    int frames = 0;
    reader.eachFrame(run_id_, [&](const db::ArchiveReader::CapturedFrame& f) {
      ++frames;
      EXPECT_EQ(f.frame.sha256, handed_->by_key[run_id_ + "/" + std::to_string(f.shot.id)]);
    });
    EXPECT_GE(frames, at_least);
    for (const auto& step : reader.steps(run_id_)) {
      EXPECT_NE(step.decision, db::Decision::kPending);
      for (const auto& shot : reader.shotsOfStep(step.id))
        EXPECT_NE(shot.state, db::ShotState::kArmed);
    }
  }

  TempFolder folder_ = TempFolder::inMemory();
  RealClock clock_;
  std::shared_ptr<capture::Gate> gate_ = std::make_shared<capture::Gate>();
  std::shared_ptr<Handed> handed_ = std::make_shared<Handed>();
  Rig rig_;
  capture::Plan plan_;
  db::ArchiveOptions options_;
  std::stop_source stop_;
  std::string run_id_;
  capture::SessionSummary summary_;
};

class HungForAWhile : public HungCamera {
 protected:
  // Three steps without cam1, then its call returns; once it has shot again, all is told.
  void afterStep(const capture::SessionStatus& status) override {
    if (status.partial == 3) gate_->open();
    if (status.partial >= 3 && status.captured > whole_before_) stop_.request_stop();
    if (status.partial < 3) whole_before_ = status.captured;
  }
  std::int64_t whole_before_ = 0;
};

TEST_F(HungForAWhile, LeavesTheOtherItsStepsAndComesBackWithNothingOfItsLatePicture) {
  run();
  EXPECT_EQ(summary_.end, "stopped");
  EXPECT_GE(summary_.last.partial, 3);
  expectNothingMixedUp(6);
  const db::ArchiveReader reader(options_.folder);
  std::set<std::string> reasons;
  for (const auto& step : reader.steps(run_id_, db::Decision::kFailed)) {
    EXPECT_EQ(step.shots_captured, 1);
    EXPECT_THAT(step.reason, ::testing::HasSubstr("cam1: timeout"));
  }
  std::vector<std::string> alarms;
  for (const auto& event : reader.events(run_id_))
    if (event.kind == "alarm") alarms.push_back(event.detail);
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_THAT(alarms[0], ::testing::HasSubstr("camera cam1 down begins"));
  EXPECT_THAT(alarms[0], ::testing::HasSubstr("collect has not returned for"));
  EXPECT_THAT(alarms[1], ::testing::HasSubstr("is over"));
  EXPECT_TRUE(rig_.cameras[1]);
}

class HungForGood : public HungCamera {
 protected:
  void afterStep(const capture::SessionStatus& status) override {
    if (status.partial == 3) stop_.request_stop();
  }
};

TEST_F(HungForGood, KeepsNoSessionFromItsEnd) {
  run();
  EXPECT_EQ(summary_.end, "stopped");
  EXPECT_TRUE(rig_.cameras[0]);
  EXPECT_FALSE(rig_.cameras[1]);
  EXPECT_EQ(capture::callsStillOut(), 1);
  expectNothingMixedUp(5);
  gate_->open();
  while (capture::callsStillOut() > 0) std::this_thread::yield();
}

}  // namespace
}  // namespace patina::testing
