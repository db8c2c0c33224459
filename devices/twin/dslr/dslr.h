// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual DSLR: a PTP responder whose pictures come from the twin's world at the present time
// of its clock. It knows no wire: PtpIpServer, or a USB device of the tests, carries what is said.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "devices/twin/dslr/body.h"
#include "devices/twin/dslr/misbehaviour.h"
#include "devices/twin/dslr/ptp_exchange.h"
#include "devices/twin/dslr/truth.h"

namespace patina::devices::twin::dslr {

// Thread-safe, as far as the world's clock is. Several may share a world: equal models with other
// serials, or other eyes.
class Dslr {
 public:
  // Failure(kConfig) when the rig has no such camera.
  Dslr(std::shared_ptr<World> world, DslrOptions options);
  Clock& clock() const { return body_.clock(); }
  const DslrOptions& options() const { return body_.options(); }

  // For whoever carries the wire.
  PtpReply perform(const PtpCommand& command);
  std::vector<PtpEvent> takeEvents();  // whose time has come
  // When there is something to do by itself: call takeEvents() then.
  std::optional<MonoTime> nextDue() const;
  bool isOn() const;  // without power no client is heard, and those there were are gone
  void hangUp();      // the client is gone: its session ends
  // Called, from any thread, when nextDue() or isOn() may have become another by what somebody else
  // did. One listener; it must not call onChange(), which waits for a call that is under way.
  void onChange(std::function<void()> call);

  // For whoever stands beside it.
  bool pressShutter();  // by the shutter line; false: busy, full or without power
  void order(const DslrFault& fault);
  void misbehave(std::uint64_t seed, double rate, Nanoseconds duration);  // rate 0: no more
  void behave();                                                          // no more orders either
  void turnOff(Nanoseconds duration);
  void setBattery(int percent);
  void set(Property property, std::int64_t value);  // a hand at its dials
  Truth truth() const;
  std::vector<TruePicture> picturesSince(std::size_t first) const;  // of truth(), from this one on

 private:
  void catchUp();  // to the present
  void losePower(Nanoseconds duration);
  PtpReply performUnder(const DslrFault& fault, const PtpCommand& command);
  void changed();

  mutable std::mutex mutex_;  // guards what follows, to the other one
  Body body_;
  Misbehaviour misbehaviour_;
  std::optional<MonoTime> off_until_;
  std::mutex listener_mutex_;  // guards on_change_; taken while mutex_ is not held
  std::function<void()> on_change_;
};

}  // namespace patina::devices::twin::dslr
