// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hid_relay.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <utility>

namespace fs = std::filesystem;

namespace patina::devices::usb {
namespace {

constexpr std::uint8_t kClose = 0xff, kOpen = 0xfd;
constexpr std::size_t kSerialBytes = 5, kStateByte = 7;
constexpr const char* kHidId = "HID_ID=0003:000016C0:000005DF";

}  // namespace

Result<RelayState> decodeRelays(const FeatureReport& report) {
  RelayState state;
  for (std::size_t i = 0; i < kSerialBytes; ++i) {
    if (std::isgraph(report[i]) == 0)
      return fail(Errc::kCorrupt, "its report holds no serial: is it a relay board?");
    state.serial += static_cast<char>(report[i]);
  }
  state.relays = report[kStateByte];
  return state;
}

FeatureReport relayCommand(int relay, bool closed) {
  return {closed ? kClose : kOpen, static_cast<std::uint8_t>(relay)};
}

std::vector<fs::path> relayNodes(const fs::path& root) {
  std::vector<fs::path> nodes;
  std::error_code error;
  for (fs::directory_iterator it(root / "sys/class/hidraw", error), end; !error && it != end;
       it.increment(error)) {
    std::ifstream uevent(it->path() / "device/uevent");
    for (std::string line; std::getline(uevent, line);)
      if (line == kHidId) nodes.push_back(root / "dev" / it->path().filename());
  }
  std::ranges::sort(nodes);
  return nodes;
}

RelayBoard::RelayBoard(std::string serial, OpenHid open, fs::path root)
    : serial_(std::move(serial)), open_hid_(std::move(open)), root_(std::move(root)) {}

Result<void> RelayBoard::open() {
  const std::lock_guard lock(mutex_);
  if (wire_ && stateLocked()) return {};
  return openLocked();
}

Result<void> RelayBoard::openLocked() {
  wire_.reset();
  std::string others, trouble;
  std::unique_ptr<HidWire> only;
  int boards = 0;
  for (const fs::path& node : relayNodes(root_)) {
    auto wire = open_hid_(node);
    if (!wire) {
      trouble += "; " + wire.error().what;
      continue;
    }
    const auto report = (*wire)->feature();
    const auto state =
        report ? decodeRelays(*report) : Result<RelayState>(tl::make_unexpected(report.error()));
    if (!state) {
      trouble += "; " + node.string() + ": " + state.error().what;
      continue;
    }
    if (state->serial == serial_) {
      wire_ = std::move(*wire);
      return {};
    }
    ++boards;
    others += (others.empty() ? "" : ", ") + state->serial;
    only = std::move(*wire);
  }
  if (serial_.empty() && boards == 1) {
    wire_ = std::move(only);
    return {};
  }
  if (serial_.empty() && boards > 1)
    return fail(Errc::kRefused, "several relay boards, give the serial as address: " + others);
  return fail(Errc::kLost, "no relay board" + (serial_.empty() ? "" : " with serial " + serial_) +
                               "; there are: " + (others.empty() ? "none" : others) + trouble);
}

Result<RelayState> RelayBoard::stateLocked() {
  if (!wire_) return fail(Errc::kLost, "the relay board is not open: recover first");
  const auto report = wire_->feature();
  auto state =
      report ? decodeRelays(*report) : Result<RelayState>(tl::make_unexpected(report.error()));
  // Another board under the old node is not ours.
  if (state && !serial_.empty() && state->serial != serial_)
    state = fail(Errc::kLost, "relay board " + state->serial + " is where " + serial_ + " was");
  if (!state) wire_.reset();
  return state;
}

Result<void> RelayBoard::set(int relay, bool closed) {
  const std::lock_guard lock(mutex_);
  if (!wire_) return fail(Errc::kLost, "the relay board is not open: recover first");
  if (auto told = wire_->setFeature(relayCommand(relay, closed)); !told) {
    wire_.reset();
    return told;
  }
  const auto state = stateLocked();
  if (!state) return tl::make_unexpected(state.error());
  if (((state->relays >> (relay - 1)) & 1u) != (closed ? 1u : 0u))
    return fail(Errc::kRefused, "relay " + std::to_string(relay) + " of board " + state->serial +
                                    " does not follow: has the board so many?");
  return {};
}

Result<bool> RelayBoard::isClosed(int relay) {
  const std::lock_guard lock(mutex_);
  const auto state = stateLocked();
  if (!state) return tl::make_unexpected(state.error());
  return ((state->relays >> (relay - 1)) & 1u) != 0;
}

}  // namespace patina::devices::usb
