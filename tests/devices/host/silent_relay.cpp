// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/host/silent_relay.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>

#include "devices/clock.h"
#include "devices/host/dial.h"

namespace patina::devices::host {

using namespace std::chrono_literals;

SilentRelay::SilentRelay(std::string to)
    : to_(std::move(to)), quit_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  auto listener = listenOn("127.0.0.1:0");
  if (!listener) throw std::runtime_error(listener.error().what);
  listener_ = std::move(*listener);
  address_ = "127.0.0.1:" + std::to_string(portOf(listener_));
  thread_ = std::thread([this] { run(); });
}

SilentRelay::~SilentRelay() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = write(quit_.fd(), &one, sizeof one);
  thread_.join();
}

void SilentRelay::carry(Pair& pair, const Descriptor& from, const Descriptor& to) {
  std::array<char, 65'536> bytes{};
  const ssize_t n = recv(from.fd(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  // After a silence what comes is lost, a connection's end too: nobody hears of it.
  if (pair.born != silences_) return;
  if (n <= 0 || send(to.fd(), bytes.data(), static_cast<std::size_t>(n), MSG_NOSIGNAL) != n)
    pair.over = true;
}

void SilentRelay::run() {
  while (true) {
    std::vector<pollfd> fds{{quit_.fd(), POLLIN, 0}, {listener_.fd(), POLLIN, 0}};
    const std::size_t pairs = pairs_.size();
    for (const Pair& pair : pairs_) {
      const bool dead = pair.born != silences_;
      fds.push_back({dead ? -1 : pair.caller.fd(), POLLIN, 0});
      fds.push_back({dead ? -1 : pair.host.fd(), POLLIN, 0});
    }
    if (poll(fds.data(), fds.size(), -1) < 0 || fds[0].revents != 0) return;
    for (std::size_t i = 0; i < pairs; ++i) {
      if (fds[2 + 2 * i].revents != 0) carry(pairs_[i], pairs_[i].caller, pairs_[i].host);
      if (fds[3 + 2 * i].revents != 0) carry(pairs_[i], pairs_[i].host, pairs_[i].caller);
    }
    std::erase_if(pairs_, [](const Pair& pair) { return pair.over; });
    if (fds[1].revents == 0) continue;
    auto caller = acceptFrom(listener_);
    auto host = dial(to_, RealClock().mono() + 10s);
    if (caller && host) pairs_.push_back({std::move(*caller), std::move(*host), silences_, false});
  }
}

}  // namespace patina::devices::host
