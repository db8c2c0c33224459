// SPDX-License-Identifier: GPL-3.0-or-later
// A call's answer as the value it is. Private to the host.
#pragma once

#include <type_traits>

#include "devices/host/driver_link.h"

namespace patina::devices::host {

inline auto damagedAnswer(Op op) {
  return fail(Errc::kCorrupt, std::string(name(op)) + ": a damaged answer came");
}

template <class T>
Result<T> answered(DriverLink& link, std::uint16_t device, Op op, const Bytes& body,
                   Nanoseconds limit) {
  const auto reply = link.call(device, op, body, limit);
  if (!reply) return tl::make_unexpected(reply.error());
  Reader from(reply->body);
  if constexpr (std::is_void_v<T>) {
    if (!from.whole()) return damagedAnswer(op);
    return {};
  } else {
    T value{};
    get(from, value);
    if (!from.whole()) return damagedAnswer(op);
    return value;
  }
}

}  // namespace patina::devices::host
