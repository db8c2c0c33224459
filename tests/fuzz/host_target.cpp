// SPDX-License-Identifier: GPL-3.0-or-later
// What the two ends of a device host believe of each other.
#include "devices/host/messages.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {

void fuzzHostMessages(std::span<const std::byte> bytes) {
  namespace host = devices::host;
  static_cast<void>(host::decodeHello(bytes));
  if (const auto call = host::decodeCall(bytes)) {
    host::Reader from(call->body);
    devices::Ticket ticket;
    get(from, ticket);
  }
  const auto answer = host::decodeAnswer(bytes);
  if (!answer) return;
  host::Reader frames(answer->body), found(answer->body);
  std::vector<devices::RawFrame> of_shot;
  std::vector<devices::FoundDevice> attached;
  get(frames, of_shot);
  get(found, attached);
}

}  // namespace patina::testing
