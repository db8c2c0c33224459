// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/listener.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "devices/host/dial.h"
#include "devices/host/seal.h"
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
  Listening() {
    patina::testing::writeFile(folder_ / "key", "0123456789abcdef");
    std::filesystem::permissions(folder_ / "key", std::filesystem::perms(0600));
    std::promise<int> port;
    auto known = port.get_future();
    thread_ = std::jthread([this, &port](const std::stop_token& stop) {
      ListenOptions options;
      options.address = "127.0.0.1:0";
      options.command = {victimProgram(), "keyed", folder_ / "key"};
      options.on_listening = [&](int chosen) { port.set_value(chosen); };
      EXPECT_THAT(listenForCallers(options, stop), IsOk());
    });
    port_ = known.get();
  }
  LinkOptions caller() const {
    LinkOptions options = victimOptions("none");
    options.remote = {"127.0.0.1:" + std::to_string(port_), folder_ / "key"};
    return options;
  }
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
