// SPDX-License-Identifier: GPL-3.0-or-later
// What goes between a client and the camera, whatever carries it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "devices/twin/dslr/ptp_codes.h"
#include "processing/image/picture_file.h"

namespace patina::devices::twin::dslr {

struct PtpCommand {
  Operation operation{};
  std::uint32_t transaction = 0;
  std::vector<std::uint32_t> parameters{};  // at most five
  Bytes data{};                             // what the client sent with it

  std::uint32_t parameter(std::size_t i) const { return i < parameters.size() ? parameters[i] : 0; }
};

// What befalls a reply on the wire, once `share` of its bytes are out.
struct WireTrouble {
  enum Kind { kStall, kReset, kClose };
  Kind kind = kStall;
  double share = 0;        // [0,1)
  Nanoseconds duration{};  // of a stall; kForEver: until the client gives up
};
constexpr Nanoseconds kForEver = Nanoseconds::max();

struct PtpReply {
  Answer answer = Answer::kOk;
  std::vector<std::uint32_t> parameters;
  std::shared_ptr<const Bytes> data;  // null: no data phase
  std::size_t first = 0, bytes = 0;   // the part of data that is sent
  std::optional<WireTrouble> trouble;
};

struct PtpEvent {
  EventCode code{};
  std::uint32_t transaction = 0;
  std::vector<std::uint32_t> parameters;  // at most three
};

}  // namespace patina::devices::twin::dslr
