// SPDX-License-Identifier: GPL-3.0-or-later
// Relay boards behind hidraw nodes.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "devices/usb/hid_wire.h"

namespace patina::testing {

struct FakeBoard {
  std::string serial = "HURTM";
  int relays = 4;
  unsigned state = 0;
  bool gone = false;
};

class FakeBoards {
 public:
  std::shared_ptr<FakeBoard> at(const std::string& node) {  // "hidraw0"
    auto& board = boards_[node];
    if (!board) board = std::make_shared<FakeBoard>();
    return board;
  }
  devices::usb::OpenHid opener() {
    return [this](const std::filesystem::path& node)
               -> devices::Result<std::unique_ptr<devices::usb::HidWire>> {
      const auto found = boards_.find(node.filename());
      if (found == boards_.end() || found->second->gone)
        return devices::fail(devices::Errc::kLost, node.filename().string() + ": no permission");
      return std::unique_ptr<devices::usb::HidWire>(std::make_unique<Wire>(found->second));
    };
  }
  void move(const std::string& from, const std::string& to) {
    boards_[to] = boards_.at(from);
    boards_.erase(from);
  }

 private:
  class Wire final : public devices::usb::HidWire {
   public:
    explicit Wire(std::shared_ptr<FakeBoard> board) : board_(std::move(board)) {}
    devices::Result<devices::usb::FeatureReport> feature() override {
      if (board_->gone) return devices::fail(devices::Errc::kLost, "fake: gone");
      devices::usb::FeatureReport report{};
      std::ranges::copy(board_->serial, report.begin());
      report[7] = static_cast<std::uint8_t>(board_->state);
      return report;
    }
    devices::Result<void> setFeature(const devices::usb::FeatureReport& report) override {
      if (board_->gone) return devices::fail(devices::Errc::kLost, "fake: gone");
      if (report[1] > board_->relays) return {};
      const unsigned bit = 1u << (report[1] - 1);
      if (report[0] == 0xff) board_->state |= bit;
      if (report[0] == 0xfd) board_->state &= ~bit;
      return {};
    }

   private:
    std::shared_ptr<FakeBoard> board_;
  };
  std::map<std::string, std::shared_ptr<FakeBoard>> boards_;
};

}  // namespace patina::testing
