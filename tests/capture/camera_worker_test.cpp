// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/camera_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <latch>

#include "tests/capture/fakes.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using devices::Errc;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A camera on the real clock, whose calls hang for as long as the test says.
class CameraWorkerTest : public ::testing::Test {
 protected:
  void start() { worker_ = std::make_unique<CameraWorker>(place_, clock_, bell_, patience_); }
  std::shared_ptr<Answer<int>> post(int value) {
    return worker_->post<int>("count", [this, value](devices::Camera&) -> devices::Result<int> {
      made_.push_back(value);
      return value;
    });
  }
  // Owns what it waits for: it may outlive the test.
  std::shared_ptr<Answer<int>> postHang() {
    return worker_->post<int>("hang",
                              [begun = begun_, go = go_](devices::Camera&) -> devices::Result<int> {
                                begun->count_down();
                                go->wait();
                                return -1;
                              });
  }
  bool arrives(const Pending& answer) {
    return bell_->wait(clock_, clock_.mono() + 1min, [&] { return answer.ready(); });
  }

  devices::RealClock clock_;
  std::shared_ptr<Doorbell> bell_ = std::make_shared<Doorbell>();
  std::shared_ptr<std::latch> begun_ = std::make_shared<std::latch>(1),
                              go_ = std::make_shared<std::latch>(1);
  std::vector<int> made_;  // by the worker's thread; read when its answers are there
  Nanoseconds patience_ = 1min;
  std::unique_ptr<devices::Camera> place_ = std::make_unique<FakeCamera>();
  std::unique_ptr<CameraWorker> worker_;
};

TEST_F(CameraWorkerTest, MakesCallsInTheOrderTheyWerePosted) {
  start();
  post(1);
  post(2);
  const auto last = post(3);
  ASSERT_TRUE(arrives(*last));
  EXPECT_EQ(*last->get(), 3);
  EXPECT_THAT(made_, ElementsAre(1, 2, 3));
}

TEST_F(CameraWorkerTest, LetsNobodyWaitBeyondTheDeadlineForACallThatHangs) {
  start();
  const auto answer = postHang();
  begun_->wait();
  EXPECT_FALSE(bell_->wait(clock_, clock_.mono(), [&] { return answer->ready(); }));
  EXPECT_STREQ(worker_->doing().call, "hang");
  EXPECT_LE(worker_->doing().since, clock_.mono());
  go_->count_down();
  ASSERT_TRUE(arrives(*answer));
  EXPECT_EQ(*answer->get(), -1);
}

TEST_F(CameraWorkerTest, KeepsOtherCamerasGoingWhileOneHangs) {
  start();
  const auto hung = postHang();
  begun_->wait();
  std::unique_ptr<devices::Camera> other_place = std::make_unique<FakeCamera>("cam1");
  CameraWorker other(other_place, clock_, bell_);
  const auto answer = other.post<int>("count", [](devices::Camera&) { return 7; });
  ASSERT_TRUE(arrives(*answer));
  EXPECT_EQ(*answer->get(), 7);
  EXPECT_FALSE(hung->ready());
  go_->count_down();
}

TEST_F(CameraWorkerTest, DoesNotMakeACallThatWasDroppedBeforeItBegan) {
  start();
  postHang();
  const auto dropped = post(1), wanted = post(2);
  dropped->drop();
  go_->count_down();
  ASSERT_TRUE(arrives(*wanted));
  EXPECT_THAT(made_, ElementsAre(2));
  EXPECT_EQ(dropped->get().error().code, Errc::kBusy);
}

TEST_F(CameraWorkerTest, AnswersLostWhenADriverThrows) {
  start();
  const auto thrown = worker_->post<int>("collect", [](devices::Camera&) -> devices::Result<int> {
    throw std::runtime_error("pipe");
  });
  const auto odd =
      worker_->post<int>("poll", [](devices::Camera&) -> devices::Result<int> { throw 42; });
  ASSERT_TRUE(arrives(*odd));
  EXPECT_EQ(thrown->get().error().code, Errc::kLost);
  EXPECT_THAT(thrown->get().error().what,
              HasSubstr("camera 'cam0': collect: its driver threw: pipe"));
  EXPECT_EQ(odd->get().error().code, Errc::kLost);
  ASSERT_TRUE(arrives(*post(1)));
}

TEST_F(CameraWorkerTest, LetsACallEndBeforeItEndsItself) {
  start();
  const auto answer = postHang();
  begun_->wait();
  std::thread ends([this] { worker_.reset(); });
  go_->count_down();
  ends.join();
  EXPECT_TRUE(answer->ready());
  EXPECT_TRUE(place_);
  EXPECT_EQ(callsStillOut(), 0);
}

TEST_F(CameraWorkerTest, MakesNoMoreCallsOnceItEnds) {
  patience_ = 0ns;
  start();
  postHang();
  begun_->wait();
  post(1);
  worker_.reset();
  go_->count_down();
  while (callsStillOut() > 0) std::this_thread::yield();
  EXPECT_TRUE(made_.empty());
}

// A camera that tells when it is closed.
class ClosingCamera final : public devices::Camera {
 public:
  explicit ClosingCamera(std::shared_ptr<std::atomic<bool>> closed) : closed_(std::move(closed)) {}
  ~ClosingCamera() override { *closed_ = true; }
  const devices::CameraCaps& caps() const override { return fake_.caps(); }
  devices::Result<devices::Applied> configure(const devices::Exposure& e) override {
    return fake_.configure(e);
  }
  devices::Result<devices::Ticket> trigger(const devices::ShotRequest& r) override {
    return fake_.trigger(r);
  }
  devices::Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& t,
                                                          MonoTime deadline) override {
    return fake_.collect(t, deadline);
  }
  devices::Result<void> release(const devices::RawFrame& f) override { return fake_.release(f); }
  devices::Result<std::vector<devices::CameraEvent>> poll() override { return fake_.poll(); }
  devices::Result<void> recover(devices::Rung r) override { return fake_.recover(r); }

 private:
  FakeCamera fake_;
  std::shared_ptr<std::atomic<bool>> closed_;
};

TEST_F(CameraWorkerTest, KeepsTheCameraOfACallThatIsStillOutUntilItReturns) {
  const auto closed = std::make_shared<std::atomic<bool>>(false);
  place_ = std::make_unique<ClosingCamera>(closed);
  patience_ = 0ns;
  start();
  const auto answer = postHang();
  begun_->wait();
  worker_.reset();
  EXPECT_FALSE(place_);
  EXPECT_EQ(callsStillOut(), 1);
  EXPECT_FALSE(*closed);
  go_->count_down();
  while (callsStillOut() > 0) std::this_thread::yield();
  EXPECT_TRUE(*closed);
  EXPECT_TRUE(answer->ready());
}

TEST(CameraWorker, MakesCallsAtOnceWhereTheClockIsOfOneThread) {
  devices::VirtualClock clock(parseUtc("2024-05-01T12:00:00Z"));
  std::unique_ptr<devices::Camera> place = std::make_unique<FakeCamera>();
  CameraWorker worker(place, clock, std::make_shared<Doorbell>());
  const auto here = std::this_thread::get_id();
  const auto answer = worker.post<bool>("ask", [&](devices::Camera&) -> devices::Result<bool> {
    clock.advance(2s);
    return std::this_thread::get_id() == here;
  });
  ASSERT_TRUE(answer->ready());
  EXPECT_TRUE(*answer->get());
  EXPECT_EQ(worker.doing().call, nullptr);
}

}  // namespace
}  // namespace patina::capture
