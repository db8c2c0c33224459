// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/inhibitor.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>
#include <thread>

#include "tests/capture/app/ack_pipe.h"
#include "tests/support/child.h"

namespace patina::daemon {
namespace {

constexpr const char* kBusDaemon = "/usr/bin/dbus-daemon";

// Gives the writing end of a pipe as the lock; the reading end tells when the last copy is gone.
class Login {
 public:
  explicit Login(const std::string& address) {
    if (pipe2(pipe_, O_CLOEXEC) != 0 || sd_bus_new(&bus_) < 0 ||
        sd_bus_set_address(bus_, address.c_str()) < 0 || sd_bus_set_bus_client(bus_, 1) < 0 ||
        sd_bus_start(bus_) < 0 ||
        sd_bus_add_object_vtable(bus_, nullptr, "/org/freedesktop/login1",
                                 "org.freedesktop.login1.Manager", kMethods, this) < 0 ||
        sd_bus_request_name(bus_, "org.freedesktop.login1", 0) < 0)
      ADD_FAILURE() << "no login manager on " << address;
  }
  ~Login() {
    sd_bus_flush_close_unref(bus_);
    close(pipe_[0]);
    if (pipe_[1] >= 0) close(pipe_[1]);
  }
  void answerOne() {
    while (!asked_)
      if (sd_bus_process(bus_, nullptr) == 0) sd_bus_wait(bus_, UINT64_MAX);
    sd_bus_flush(bus_);
    close(pipe_[1]);
    pipe_[1] = -1;
  }
  bool lockIsHeld() const {
    pollfd fd{pipe_[0], POLLIN, 0};
    return poll(&fd, 1, 0) == 0;
  }
  // The bus may keep its own copy for a moment; without a release this lasts for ever.
  void waitForRelease() const {
    pollfd fd{pipe_[0], 0, 0};
    while (poll(&fd, 1, -1) < 1) continue;
  }
  std::string what() const { return what_; }

 private:
  static int inhibit(sd_bus_message* message, void* self, sd_bus_error*) {
    auto& login = *static_cast<Login*>(self);
    const char *what = "", *who = "", *why = "", *mode = "";
    sd_bus_message_read(message, "ssss", &what, &who, &why, &mode);
    login.what_ = std::string(what) + " " + mode;
    login.asked_ = true;
    return sd_bus_reply_method_return(message, "h", login.pipe_[1]);
  }
  static const sd_bus_vtable kMethods[];

  sd_bus* bus_ = nullptr;
  int pipe_[2] = {-1, -1};
  bool asked_ = false;
  std::string what_;
};
const sd_bus_vtable Login::kMethods[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("Inhibit", "ssss", "h", Login::inhibit, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_VTABLE_END};

TEST(Inhibitor, HoldsTheLockFromTheFirstRunToTheLast) {
  if (access(kBusDaemon, X_OK) != 0) GTEST_SKIP() << "dbus-daemon is not installed";
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  const std::string address = "unix:path=" + (folder / "bus").string();
  testing::writeFile(folder / "bus.conf",
                     "<busconfig><type>system</type><listen>" + address +
                         "</listen><auth>EXTERNAL</auth><policy context=\"default\"><allow "
                         "own=\"*\"/><allow send_destination=\"*\"/><allow receive_sender=\"*\"/>"
                         "<allow user=\"*\"/></policy></busconfig>");
  const testing::AckPipe ready(folder / "ready");
  const testing::Child bus({"/bin/sh", "-c",
                            std::string("exec ") + kBusDaemon +
                                " --nofork --nopidfile "
                                "--print-address=1 --config-file=" +
                                (folder / "bus.conf").string() + " > " + ready.path()});
  ready.line();
  Login login(address);
  setenv("DBUS_SYSTEM_BUS_ADDRESS", address.c_str(), 1);
  std::thread manager([&] { login.answerOne(); });
  Inhibitor inhibitor;
  EXPECT_EQ(inhibitor.take(), "");
  manager.join();
  unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
  EXPECT_TRUE(inhibitor.held());
  EXPECT_EQ(inhibitor.take(), "");  // asks nobody again
  EXPECT_EQ(login.what(), "sleep:idle block");
  EXPECT_TRUE(login.lockIsHeld());
  inhibitor.release();
  login.waitForRelease();
  EXPECT_FALSE(inhibitor.held());
}

TEST(Inhibitor, WithoutABusItSaysSoOnceAndGoesOn) {
  setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/no/such/bus", 1);
  Inhibitor inhibitor;
  EXPECT_THAT(inhibitor.take(), ::testing::HasSubstr("suspend is off"));
  EXPECT_EQ(inhibitor.take(), "");
  EXPECT_FALSE(inhibitor.held());
  inhibitor.release();
  unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
}

}  // namespace
}  // namespace patina::daemon
