// SPDX-License-Identifier: GPL-3.0-or-later
// The common HID relay board (16c0:05df, "USBRelay1" to "USBRelay8"): it tells its own serial of
// five characters and the state of its relays, so a lamp on it confirms that the relay obeyed.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "devices/result.h"
#include "devices/usb/hid_wire.h"

namespace patina::devices::usb {

constexpr int kRelaysMax = 8;

struct RelayState {
  std::string serial;
  unsigned relays = 0;  // bit 0 = relay 1
};
// kCorrupt when the report is not of such a board.
Result<RelayState> decodeRelays(const FeatureReport& report);
FeatureReport relayCommand(int relay, bool closed);  // relay from 1

// hidraw nodes that say they are such a board, in order.
std::vector<std::filesystem::path> relayNodes(const std::filesystem::path& root = "/");

// A board by its serial ("": the only one there is), wherever it is plugged in. Thread-safe: the
// devices on it share it.
class RelayBoard {
 public:
  RelayBoard(std::string serial, OpenHid open, std::filesystem::path root);

  // Finds it again when it is not open or does not answer. kLost with the boards that are there.
  Result<void> open();
  Result<void> set(int relay, bool closed);  // and reads back: kRefused when it does not follow
  Result<bool> isClosed(int relay);

 private:
  Result<RelayState> stateLocked();
  Result<void> openLocked();

  const std::string serial_;
  const OpenHid open_hid_;
  const std::filesystem::path root_;
  std::mutex mutex_;
  std::unique_ptr<HidWire> wire_;
};

}  // namespace patina::devices::usb
