// SPDX-License-Identifier: GPL-3.0-or-later
// Is this file on the card the picture of that trigger? PTP names no trigger with a picture, so it
// takes proofs: it was not there before, and the camera's clock puts its exposure after the trigger
// and after everything whose fate is not known; where a picture tells no time, its number must
// rise.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "devices/gphoto2/clock_offset.h"
#include "devices/gphoto2/session.h"
#include "processing/image/metadata_file.h"

namespace patina::devices::gphoto2 {

// Which files the card has shown. Bounded: of single files the last 1024 are kept, of a folder and
// prefix ("DSC_") the highest number.
class SeenNames {
 public:
  void note(const CardFile& file);
  void erased(const CardFile& file);  // its name may come again
  bool known(const CardFile& file) const { return files_.contains(file.path()); }
  // Its number is above all before it, or it belongs to the highest (RAW and JPEG share one). Only
  // numbers in DCIM folders mean anything; elsewhere the library counts.
  bool rises(const CardFile& file) const;
  void forget() { *this = SeenNames{}; }  // another card, another numbering

 private:
  std::map<std::string, long> highest_;  // by folder and prefix
  std::set<std::string> files_;
  std::deque<std::string> in_order_;  // oldest first; may hold erased ones
};

struct ShotWindow {
  MonoTime told;     // just before the trigger
  MonoTime arrived;  // when the card showed the file
  // Whatever was exposed up to here may be of a shot that was given up, or of another life.
  std::optional<MonoTime> fence;
};

enum class Proof {
  kOurs,
  kEarlier,   // exposed before the trigger
  kLater,     // exposed after it arrived: the camera's clock was set
  kUncertain  // could be of a shot that was given up
};
// `taken`: when the camera's clock says it was exposed.
Proof judge(const ClockOffset::Span& taken, const ShotWindow& window);
// When the next trigger's picture can be told from whatever came up to `fence`.
MonoTime tellableFrom(MonoTime fence, const ClockOffset& offset, Nanoseconds resolution);

// How finely pictures of this camera tell their time: learned from those that came.
class TimeResolution {
 public:
  void observe(UtcTime shown);
  Nanoseconds value() const { return value_.value_or(kHoped); }  // hoped for until one came

 private:
  static constexpr Nanoseconds kHoped = std::chrono::milliseconds(10);
  std::optional<Nanoseconds> value_;
};

// What is known of one camera's time, and of what is behind it.
class PictureJudge {
 public:
  ClockOffset offset;

  // A shot was given up, or a session began: whatever was exposed up to `now` is of no later shot.
  void fenceOff(MonoTime now) { fence_ = now; }
  // When a trigger's picture can be told from what is behind the fence.
  MonoTime tellable() const;
  struct Moment {
    MonoTime told, arrived;
  };
  // `rises`: its number does. A picture without time is believed by that alone, long after a fence.
  Proof judge(const PictureMetadata& picture, Moment moment, bool rises);
  // It was ours: its time narrows the offset of the camera's clock.
  void accept(const PictureMetadata& picture, Moment moment);
  // When it was exposed, as far as that is known: the middle of what its time allows.
  std::optional<MonoTime> exposedAt(const PictureMetadata& picture, MonoTime arrived) const;

 private:
  std::optional<UtcTime> shownBy(const PictureMetadata& picture, MonoTime at) const;

  TimeResolution resolution_;
  std::optional<MonoTime> fence_;
  std::optional<Nanoseconds> zone_;  // of pictures that name one: their UTC plus this is shown
};
const char* name(Proof proof);  // for messages: "exposed before the trigger"

}  // namespace patina::devices::gphoto2
