// SPDX-License-Identifier: GPL-3.0-or-later
// Device failure is normal traffic: a value, not an exception.
#pragma once

#include <string>
#include <tl/expected.hpp>

namespace patina::devices {

// What the CALLER should do about it.
enum class Errc {
  kBusy,         // try again within the slot
  kTimeout,      // state unknown: recover() before the next call
  kLost,         // unplugged or its session died: recover()
  kCorrupt,      // the bytes or the reply cannot be trusted: shoot again
  kUnsupported,  // never with this unit: the plan is wrong
  kRefused       // the device said no to this setting
};
const char* name(Errc code);

struct Error {
  Errc code;
  std::string what;  // "twin 'cam0': collect: no picture within 12 s"
};

// Debian's tl::expected 1.0.0 is not nodiscard; and_then() with a Result does not compile on it:
// plain early returns, `if (!r) return tl::make_unexpected(r.error());`.
template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
  using Base = tl::expected<T, Error>;

 public:
  using Base::Base;
  Result(Base b) : Base(std::move(b)) {}
};

inline auto fail(Errc code, std::string what) {
  return tl::make_unexpected(Error{code, std::move(what)});
}

}  // namespace patina::devices
