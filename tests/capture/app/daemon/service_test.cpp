// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/service.h"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;

// The service manager's end of the notify socket.
class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() {
    const std::string path = folder_ / "notify";
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "20000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  }
  ~ServiceTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
    close(socket_);
  }
  std::string heard() const {  // all of it
    std::string all;
    char text[512];
    for (ssize_t n; (n = recv(socket_, text, sizeof text, 0)) > 0;)
      all += std::string(text, static_cast<std::size_t>(n)) + "|";
    return all;
  }

  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  devices::VirtualClock clock_{parseUtc("2024-05-01T12:00:00Z")};
  int socket_ = -1;
};

TEST_F(ServiceTest, TellsThatItIsReadyWhatItDoesAndThatItStops) {
  notifyReady("ready");
  notifyStatus("step 3\nREADY=0");  // a line of its own would be a command
  notifyStopping();
  EXPECT_EQ(heard(),
            "READY=1\nSTATUS=ready|STATUS=step 3 READY=0|STOPPING=1\nSTATUS=finishing the "
            "frames|");
}

TEST_F(ServiceTest, PingsOnlyWhenEveryLoopHasTurned) {
  Watchdog watchdog(clock_);
  watchdog.begin("main");
  watchdog.begin("run");
  watchdog.turned("main");
  watchdog.turned("main");
  EXPECT_EQ(heard(), "");
  watchdog.turned("run");
  EXPECT_EQ(heard(), "WATCHDOG=1|");
  clock_.advance(10s);
  watchdog.turned("run");  // the main loop hangs
  watchdog.turned("run");
  EXPECT_EQ(heard(), "");
  watchdog.turned("main");
  EXPECT_EQ(heard(), "WATCHDOG=1|");
}

TEST_F(ServiceTest, ALoopThatHasEndedIsNotWaitedFor) {
  Watchdog watchdog(clock_);
  watchdog.begin("main");
  watchdog.begin("run");
  watchdog.end("run");
  watchdog.turned("main");
  EXPECT_EQ(heard(), "WATCHDOG=1|");
}

TEST_F(ServiceTest, FastLoopsPingNoMoreThanIsNeeded) {
  Watchdog watchdog(clock_);
  watchdog.begin("main");
  for (int i = 0; i < 1000; ++i) {
    watchdog.turned("main");
    clock_.advance(1ms);
  }
  EXPECT_EQ(heard(), "WATCHDOG=1|");
  EXPECT_EQ(watchdog.patience(), 10s);
}

TEST_F(ServiceTest, WithoutAManagerThatAsksNothingIsSent) {
  unsetenv("WATCHDOG_USEC");
  Watchdog watchdog(clock_);
  watchdog.begin("main");
  watchdog.turned("main");
  EXPECT_EQ(heard(), "");
  EXPECT_EQ(watchdog.patience(), 15s);
}

}  // namespace
}  // namespace patina::daemon
