// SPDX-License-Identifier: GPL-3.0-or-later
// One DMX universe and who sends it: 512 slots, those of no lamp are 0.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "devices/dmx/cadence.h"
#include "devices/dmx/packets.h"
#include "devices/dmx/udp_link.h"

namespace patina::devices::dmx {

struct Universe {
  enum Protocol { kArtNet, kSacn } protocol = kArtNet;
  UdpTarget target;
  int number = 0;
  SacnSource source;
};

struct SlotLevel {
  int slot = 0;  // from 0
  std::uint8_t level = 0;
};

// Thread-safe. With a thread-safe clock a thread of its own repeats the universe; with any other
// each put() sends once and nothing is repeated. Destruction sends dark three times and ends the
// stream.
class UniverseSender {
 public:
  UniverseSender(Universe universe, Clock& clock);
  ~UniverseSender();
  UniverseSender(const UniverseSender&) = delete;

  const Universe& universe() const { return universe_; }
  // Answers the lamp that has one of these slots already, else takes them for `lamp`.
  std::optional<std::string> claim(const std::string& lamp, const std::vector<int>& slots);
  void giveUp(const std::string& lamp);

  Result<void> open();  // idempotent; sends the universe as it is
  // Sends at once; light waits for the shortest distance of two packets (23 ms), darkness does not.
  // When light cannot be sent its slots fall back to 0. What is as it was is left to the thread,
  // and the answer says whether its last packet went out.
  Result<void> put(const std::vector<SlotLevel>& levels);

 private:
  Result<void> sendLocked();
  std::vector<std::uint8_t> packetLocked();
  void repeat(const std::stop_token& stop);

  const Universe universe_;
  Clock& clock_;
  std::mutex mutex_;  // all below
  UdpLink link_;
  Slots slots_{};
  std::map<int, std::string> owners_;  // of slots
  std::uint8_t sequence_ = 0;
  Cadence cadence_;
  Result<void> last_;
  std::stop_source wake_;  // ends the thread's present sleep
  std::jthread thread_;
};

}  // namespace patina::devices::dmx
