// SPDX-License-Identifier: GPL-3.0-or-later
// Is a picture that came after the trigger also from after it? Pure.
#pragma once

#include <optional>
#include <string>

#include "devices/network/http_get.h"
#include "processing/image/sha256.h"

namespace patina::devices::network {

class Freshness {
 public:
  // The first answer says how far the camera's clock is from ours. `utc` and `mono` are now.
  void learn(const HttpReply& reply, UtcTime utc, MonoTime mono);
  // Why it is older than the trigger; empty: nothing speaks against it.
  std::string whyStale(const HttpReply& reply, MonoTime trigger) const;
  // What a stale one would repeat: every picture, wanted or not.
  void remember(const HttpReply& reply) { last_ = sha256(reply.body); }

 private:
  MonoTime latestOf(UtcTime by_camera) const;

  Nanoseconds camera_ahead_{};  // its seconds since 1970 less our mono()
  bool has_clock_ = false;      // its answers are dated
  std::optional<Sha256> last_;
};

}  // namespace patina::devices::network
