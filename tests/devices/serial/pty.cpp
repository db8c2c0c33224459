// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/serial/pty.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace patina::testing {

Pty::Pty(Answer answer) : answer_(std::move(answer)) {
  int master = -1, slave = -1;
  std::array<char, 128> name{};
  if (openpty(&master, &slave, name.data(), nullptr, nullptr) != 0)
    throw std::system_error(errno, std::generic_category(), "openpty");
  master_ = devices::Descriptor(master);
  kept_open_ = devices::Descriptor(slave);  // or the master hangs up before anyone has opened it
  termios raw{};
  tcgetattr(slave, &raw);
  cfmakeraw(&raw);
  tcsetattr(slave, TCSANOW, &raw);
  path_ = name.data();
  std::array<int, 2> stop{};
  if (pipe2(stop.data(), O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "pipe2");
  stop_read_ = devices::Descriptor(stop[0]);
  stop_write_ = devices::Descriptor(stop[1]);
  thread_ = std::thread([this] { serve(); });
}

Pty::~Pty() { unplug(); }

void Pty::unplug() {
  stop_write_ = devices::Descriptor();
  if (thread_.joinable()) thread_.join();
  kept_open_ = devices::Descriptor();
  master_ = devices::Descriptor();
}

void Pty::say(const std::string& bytes) const {
  if (write(master_.fd(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "write");
}

void Pty::sayAndArrive(const std::string& bytes) const {
  say(bytes);
  pollfd one{kept_open_.fd(), POLLIN, 0};
  if (poll(&one, 1, 10'000) != 1) throw std::runtime_error("the bytes did not arrive");
}

void Pty::serve() {
  std::string pending;
  while (true) {
    std::array<pollfd, 2> fds{{{master_.fd(), POLLIN, 0}, {stop_read_.fd(), 0, 0}}};
    if (poll(fds.data(), fds.size(), -1) < 0 || fds[1].revents != 0) return;
    std::array<char, 256> bytes{};
    const ssize_t n = read(master_.fd(), bytes.data(), bytes.size());
    if (n <= 0) return;
    pending.append(bytes.data(), static_cast<std::size_t>(n));
    for (auto end = pending.find('\n'); end != std::string::npos; end = pending.find('\n')) {
      const std::string line = pending.substr(0, end);
      pending.erase(0, end + 1);
      if (answer_)
        if (const std::string reply = answer_(line); !reply.empty()) say(reply);
    }
  }
}

}  // namespace patina::testing
