// SPDX-License-Identifier: GPL-3.0-or-later
// A real daemon on the quick example, a thousand times as fast as time: a step a minute of its
// time is one in 60 ms of ours.
#pragma once

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "tests/capture/app/ack_pipe.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {

// The service manager's end of $NOTIFY_SOCKET: a test waits for the daemon by what it tells.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path) : path_(path) {
    fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ~NotifySocket() { close(fd_); }
  const std::string& path() const { return path_; }

  // Until it has told `words`; false when the process has ended before.
  bool wait(pid_t process, const std::string& words) const {
    const int ended = static_cast<int>(syscall(SYS_pidfd_open, process, 0));
    bool told = false, alive = ended >= 0;
    while (!told && alive) {
      pollfd fds[] = {{fd_, POLLIN, 0}, {ended, POLLIN, 0}};
      poll(fds, 2, -1);
      char text[4096];
      if (fds[0].revents != 0) {
        const ssize_t bytes = recv(fd_, text, sizeof text, 0);
        told = bytes > 0 &&
               std::string(text, static_cast<std::size_t>(bytes)).find(words) != std::string::npos;
      } else {
        alive = fds[1].revents == 0;
      }
    }
    close(ended);
    return told;
  }

 private:
  std::string path_;
  int fd_ = -1;
};

class LiveDaemon : public ::testing::Test {
 protected:
  // Returns when it is ready. More options behind those of every test.
  void begin(const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = {program(),    "daemon",     "--archive", archive(),
                                        "--rehearse", "--speed",    "1000",      "--port",
                                        "0",          "--log-acks", pipe_.path()};
    command.insert(command.end(), more.begin(), more.end());
    std::vector<std::string> environment = environment_;
    environment.push_back("NOTIFY_SOCKET=" + manager_.path());
    daemon_.emplace(command, environment);
    ASSERT_TRUE(waitFor("READY=1")) << end(SIGTERM).err;
  }
  void beginWithPlan() {
    begin({"--start", plan_});
    pipe_.line();
  }
  bool waitFor(const std::string& words) { return manager_.wait(daemon_->pid(), words); }
  Finished end(int signal) {
    daemon_->signal(signal);
    Finished finished = daemon_->wait();
    daemon_.reset();
    return finished;
  }

  Finished ask(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--archive", archive()});
    return runPatina(std::move(arguments), environment_);
  }
  JsonAnswer answer(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return answerOf(ask(std::move(arguments)));
  }
  std::string run() { return answer({"run", "list"}).text("/items/0/id"); }
  std::string state() { return answer({"archive", "list"}).text("/items/0/state"); }
  std::string archive() { return folder_ / "a"; }
  // Frames that were acknowledged from now on, as "ack RUN ...".
  std::string nextAck() { return pipe_.line(); }

  TempFolder files_ = TempFolder::inMemory(), folder_ = TempFolder::inMemory();
  AckPipe pipe_{folder_ / "acks"};
  NotifySocket manager_{folder_ / "notify"};
  const std::vector<std::string> environment_ = {
      "RUNTIME_DIRECTORY=" + (folder_ / "run").string(),
      "DBUS_SYSTEM_BUS_ADDRESS=unix:path=" + (folder_ / "no-bus").string()};
  const std::string plan_ = changedPlan(
      files_, {{"\"10min\"", "\"1min\""}, {"\"2h\"", "\"7d\""}, {"[\"ttf\", \"film\"]", "[]"}});
  std::optional<Child> daemon_;
};

}  // namespace patina::testing
