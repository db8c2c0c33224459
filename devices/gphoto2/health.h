// SPDX-License-Identifier: GPL-3.0-or-later
// What changes slowly while a run goes on: battery, shutter counter, card, the camera's clock. Read
// now and then, which also keeps the camera awake; told when it changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/clock.h"
#include "devices/gphoto2/clock_offset.h"
#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

// Share of a full battery in per cent: "85%", "Low" is 10; nothing for what says nothing.
std::optional<int> batteryPercent(const std::string& value);
constexpr int kBatteryLowPercent = 20;
constexpr std::uint64_t kCardLowBytes = 1'000'000'000;

class Health {
 public:
  Health(std::string who, Clock& clock) : who_(std::move(who)), clock_(clock) {}

  // Due ones only; a question that the camera cannot answer is not asked again in this session.
  Result<std::vector<CameraEvent>> look(Session& session, ClockOffset& offset);
  void newSession();

 private:
  std::optional<CameraEvent> lookAtBattery(const std::string& value);

  std::string who_;
  Clock& clock_;
  std::optional<MonoTime> looked_;
  bool has_battery_ = true, has_counter_ = true, has_cards_ = true, has_clock_ = true;
  std::string battery_, counter_;
  bool card_low_ = false;
};

// Reads the camera's clock, as often as it takes to see it tick: its offset is then known to some
// hundredths of a second. False: it has no clock that can be read, or one that stands still.
bool measureClock(Session& session, ClockOffset& offset, Clock& clock);

}  // namespace patina::devices::gphoto2
