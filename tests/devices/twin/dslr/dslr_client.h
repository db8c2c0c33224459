// SPDX-License-Identifier: GPL-3.0-or-later
// What tests ask of a camera without any wire.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/twin/dslr/dslr.h"
#include "devices/twin/dslr/ptp_data.h"

namespace patina::devices::twin::dslr {

class DslrClient {
 public:
  explicit DslrClient(Dslr& camera) : camera_(camera) { ask(Operation::kOpenSession, {1}); }

  PtpReply ask(Operation operation, std::vector<std::uint32_t> parameters = {}, Bytes data = {}) {
    return camera_.perform({operation, ++transaction_, std::move(parameters), std::move(data)});
  }
  Answer set(Property property, std::int64_t value, int bytes) {
    PtpWriter out;
    out.number(static_cast<std::uint64_t>(value), bytes);
    return ask(Operation::kSetDevicePropValue, {static_cast<std::uint32_t>(property)}, out.take())
        .answer;
  }
  std::int64_t get(Property property) {
    const Bytes bytes =
        bytesOf(ask(Operation::kGetDevicePropValue, {static_cast<std::uint32_t>(property)}));
    return static_cast<std::int64_t>(PtpReader(bytes).number(static_cast<int>(bytes.size())));
  }
  std::vector<std::uint32_t> files() {
    const Bytes bytes = bytesOf(ask(Operation::kGetObjectHandles, {kAllStores, 0, 0}));
    PtpReader from(bytes);
    std::vector<std::uint32_t> files;
    for (std::uint32_t left = from.u32(); left > 0; --left) {
      const std::uint32_t handle = from.u32();
      if (ask(Operation::kGetObject, {handle}).answer == Answer::kOk) files.push_back(handle);
    }
    return files;
  }
  std::string nameOf(std::uint32_t handle) {
    const Bytes bytes = bytesOf(ask(Operation::kGetObjectInfo, {handle}));
    PtpReader from(bytes);
    from.raw(52);
    return from.text();
  }
  Bytes download(std::uint32_t handle) { return bytesOf(ask(Operation::kGetObject, {handle})); }

  static Bytes bytesOf(const PtpReply& reply) {
    if (!reply.data) return {};
    const auto part = std::span(*reply.data).subspan(reply.first, reply.bytes);
    return {part.begin(), part.end()};
  }

 private:
  Dslr& camera_;
  std::uint32_t transaction_ = 0;
};

}  // namespace patina::devices::twin::dslr
