// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/listener.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "devices/host/dial.h"
#include "devices/host/seal.h"
#include "tests/devices/host/silent_relay.h"
#include "tests/devices/host/victim_link.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::HasSubstr;

// Listens in this process; the victim serves each connection with the key of `folder`.
class Listening {
 public:
  explicit Listening(int callers_max = 16) {
    patina::testing::writeFile(folder_ / "key", "0123456789abcdef");
    std::filesystem::permissions(folder_ / "key", std::filesystem::perms(0600));
    std::promise<int> port;
    auto known = port.get_future();
    thread_ = std::jthread([this, callers_max, &port](const std::stop_token& stop) {
      ListenOptions options;
      options.address = "127.0.0.1:0";
      options.command = {victimProgram(), "keyed", folder_ / "key"};
      options.callers_max = callers_max;
      options.on_listening = [&](int chosen) { port.set_value(chosen); };
      EXPECT_THAT(listenForCallers(options, stop), IsOk());
    });
    port_ = known.get();
  }
  LinkOptions caller() const {
    LinkOptions options = victimOptions("none");
    options.remote = {address(), folder_ / "key"};
    options.ask_every = 100ms;
    options.silence_max = 1s;
    return options;
  }
  LinkOptions callerThrough(const SilentRelay& relay) const {
    LinkOptions options = caller();
    options.remote->address = relay.address();
    return options;
  }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  std::filesystem::path folder() const { return folder_.path(); }

 private:
  patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
  int port_ = 0;
  std::jthread thread_;
};

TEST(Listener, ServesACameraToWhoHasTheKey) {
  Listening there;
  RealClock clock;
  auto link = std::make_shared<DriverLink>(there.caller(), clock);
  auto camera =
      makeHostedCamera(patina::testing::makeStubCamera("cam0", clock)->caps(), link, 0, {}, clock);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  const auto before = clock.utc();
  const auto ticket = camera->trigger({"run/1", 1});
  ASSERT_THAT(ticket, IsOk());
  const auto frames = camera->collect(*ticket, clock.mono() + 10s);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ((*frames)[0].seen->size, (SizePx{16, 12}));
  // The same machine's clock, so the offset is what half of a greeting takes.
  EXPECT_LT(std::chrono::abs(ticket->began_utc - before), 2s);
}

TEST(Listener, ALinkThatIsCutIsALossAndCanBeRestored) {
  Listening there;
  RealClock clock;
  auto link = std::make_shared<DriverLink>(there.caller(), clock);
  auto camera =
      makeHostedCamera(patina::testing::makeStubCamera("cam0", clock)->caps(), link, 0, {}, clock);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  link->stop();
  EXPECT_THAT(camera->trigger({"run/1", 1}), Fails(Errc::kLost));
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(camera->trigger({"run/1", 2}), IsOk());
}

// Nobody hears of the end: neither end of the link is told, and both find it out.
TEST(Listener, ALinkThatGoesSilentIsAHungCameraAndComesBack) {
  Listening there(1);  // the old link must be over before a new one is served
  SilentRelay relay(there.address());
  RealClock clock;
  auto link = std::make_shared<DriverLink>(there.callerThrough(relay), clock);
  CameraLimits patient;
  patient.call = 1h;
  auto camera = makeHostedCamera(patina::testing::makeStubCamera("cam0", clock)->caps(), link, 0,
                                 patient, clock);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  const auto ticket = camera->trigger({"run/1", 1});
  ASSERT_THAT(ticket, IsOk());
  relay.silence();
  const auto frames = camera->collect(*ticket, clock.mono() + 1h);
  ASSERT_FALSE(frames);
  EXPECT_THAT(frames.error().code, ::testing::AnyOf(Errc::kTimeout, Errc::kLost));
  EXPECT_FALSE(link->running());
  for (int tries = 0; tries < 30 && !camera->recover(Rung::kReopen); ++tries)
    clock.sleepUntil(clock.mono() + 500ms, {});
  ASSERT_THAT(camera->trigger({"run/1", 2}), IsOk());
}

TEST(Listener, ALinkThatGoesSilentBetweenCallsIsFoundBeforeTheNext) {
  Listening there;
  SilentRelay relay(there.address());
  RealClock clock;
  DriverLink link(there.callerThrough(relay), clock);
  ASSERT_THAT(link.start(), IsOk());
  relay.silence();
  for (int tries = 0; tries < 100 && link.running(); ++tries)
    clock.sleepUntil(clock.mono() + 100ms, {});
  EXPECT_FALSE(link.running());
  const auto called = link.call(0, Op::kPing, {}, 1h);
  EXPECT_THAT(called, Fails(Errc::kLost));
  EXPECT_THAT(called.error().what, HasSubstr("is not running since"));
}

TEST(Listener, ACallerWhoIsOnlyPatientIsKept) {
  Listening there;
  RealClock clock;
  DriverLink link(there.caller(), clock);
  ASSERT_THAT(link.start(), IsOk());
  clock.sleepUntil(clock.mono() + 1500ms, {});  // longer than the host bears silence
  EXPECT_THAT(link.call(0, Op::kPing, {}, 10s), IsOk());
  EXPECT_EQ(link.startCount(), 1);
}

TEST(Listener, AStrangerGetsNothing) {
  Listening there;
  RealClock clock;
  LinkOptions options = there.caller();
  options.remote->key = there.folder() / "other";
  patina::testing::writeFile(options.remote->key, "fedcba9876543210");
  std::filesystem::permissions(options.remote->key, std::filesystem::perms(0600));
  DriverLink link(options, clock);
  const auto started = link.start();
  EXPECT_THAT(started, Fails(Errc::kRefused));
  EXPECT_THAT(started.error().what, HasSubstr("another shared key"));
}

}  // namespace
}  // namespace patina::devices::host
