// SPDX-License-Identifier: GPL-3.0-or-later
// A port that writes down what is done to it, for what a pseudo terminal has not: control lines.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "devices/serial/port.h"

namespace patina::testing {

class FakePort final : public devices::serial::Port {
 public:
  explicit FakePort(const devices::Clock& clock) : clock_(clock), start_(clock.mono()) {}

  devices::Result<void> open() override {
    is_open = true;
    return {};
  }
  devices::Result<void> send(std::string_view command, MonoTime) override {
    if (!is_open) return gone();
    did.push_back("send " + std::string(command));
    return {};
  }
  devices::Result<std::string> readLine(MonoTime) override {
    if (!is_open) return gone();
    if (lines.empty()) return devices::fail(devices::Errc::kTimeout, "fake: nothing");
    std::string line = lines.front();
    lines.pop_front();
    return line;
  }
  devices::Result<std::string> ask(std::string_view command, std::string_view,
                                   MonoTime deadline) override {
    if (auto sent = send(command, deadline); !sent) return tl::make_unexpected(sent.error());
    return readLine(deadline);
  }
  devices::Result<void> setLine(devices::serial::ControlLine line, bool asserted) override {
    if (!is_open) return gone();
    const auto at = std::chrono::duration_cast<std::chrono::milliseconds>(clock_.mono() - start_);
    did.push_back((line == devices::serial::ControlLine::kRts ? "rts " : "dtr ") +
                  std::string(asserted ? "1 " : "0 ") + std::to_string(at.count()));
    return {};
  }

  bool is_open = false;
  std::deque<std::string> lines;  // what it will say
  std::vector<std::string> did;   // "send FIRE", "rts 1 300": ms since it was made

 private:
  static tl::unexpected<devices::Error> gone() {
    return devices::fail(devices::Errc::kLost, "fake: not open");
  }
  const devices::Clock& clock_;
  MonoTime start_;
};

}  // namespace patina::testing
