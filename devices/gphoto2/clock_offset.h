// SPDX-License-Identifier: GPL-3.0-or-later
// How far a camera's own clock is from this machine's boot timeline. A camera tells its time in
// whole seconds, a picture its own with one to three digits more: each reading gives an interval,
// and all of them together a narrow one. It widens again by what a quartz may drift.
#pragma once

#include <optional>
#include <string>

#include "processing/image/units.h"

namespace patina::devices::gphoto2 {

class ClockOffset {
 public:
  // The camera's clock showed `shown`, cut down to a multiple of `resolution`, at some time within
  // [from, to]. False: this contradicts what was known, so that its clock was set; what was known
  // is given up for this reading.
  bool observe(UtcTime shown, Nanoseconds resolution, MonoTime from, MonoTime to);

  bool known() const { return known_.has_value(); }
  // Width of the interval at `at`; a reading of the camera's clock is that uncertain.
  Nanoseconds width(MonoTime at) const;
  // When, on the boot timeline, the camera's clock may have shown `shown`.
  struct Span {
    MonoTime earliest, latest;
  };
  Span when(UtcTime shown, Nanoseconds resolution, MonoTime at) const;
  // The middle of the interval, against UTC that read `utc` at `at`: positive, it is fast.
  Nanoseconds aheadOfUtc(UtcTime utc, MonoTime at) const;

  // For another process of the same boot. What is no such text is not known.
  std::string text() const;
  static ClockOffset of(const std::string& text);

 private:
  struct Interval {
    Nanoseconds least{}, most{};  // camera's clock minus boot timeline
  };
  Interval widened(MonoTime at) const;

  std::optional<Interval> known_;
  MonoTime seen_;
};

}  // namespace patina::devices::gphoto2
