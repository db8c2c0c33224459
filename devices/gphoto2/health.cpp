// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/health.h"

#include <cstdlib>

#include "devices/gphoto2/applied_settings.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kEvery = 20s;
constexpr Nanoseconds kTick = 1s;  // cameras tell their time in whole seconds
constexpr Nanoseconds kKnownWell = 60ms;
constexpr Nanoseconds kPause = 40ms;

// An error that says the camera has no such thing, as against one that it is gone.
bool has(const Error& error) { return error.code != Errc::kUnsupported; }

}  // namespace

std::optional<int> batteryPercent(const std::string& value) {
  char* end = nullptr;
  const long v = std::strtol(value.c_str(), &end, 10);
  if (end != value.c_str() && v >= 0 && v <= 100) return static_cast<int>(v);
  const std::string text = lowerCase(value);
  if (text.find("low") != std::string::npos || text.find("empty") != std::string::npos) return 10;
  if (text.find("half") != std::string::npos || text.find("normal") != std::string::npos) return 50;
  if (text.find("full") != std::string::npos) return 100;
  return std::nullopt;
}

void Health::newSession() {
  looked_.reset();
  has_battery_ = has_counter_ = has_cards_ = has_clock_ = true;
}

std::optional<CameraEvent> Health::lookAtBattery(const std::string& value) {
  if (value == battery_) return std::nullopt;
  battery_ = value;
  const auto percent = batteryPercent(value);
  std::string what = "camera '" + who_ + "': battery " + value;
  if (percent && *percent <= kBatteryLowPercent)
    what += ": low; give it a mains adapter, or it will hang and go";
  return CameraEvent{what};
}

Result<std::vector<CameraEvent>> Health::look(Session& session, ClockOffset& offset) {
  std::vector<CameraEvent> events;
  if (looked_ && clock_.mono() - *looked_ < kEvery) return events;
  looked_ = clock_.mono();

  const auto ask = [&](bool& can, const std::string& thing) -> Result<std::string> {
    if (!can) return std::string();
    const auto setting = readAny(session, thing, who_);
    if (setting) return setting->second.value;
    can = has(setting.error());
    if (can) return tl::make_unexpected(setting.error());
    return std::string();
  };
  const auto battery = ask(has_battery_, "battery");
  if (!battery) return tl::make_unexpected(battery.error());
  if (const auto event = lookAtBattery(*battery)) events.push_back(*event);
  const auto counter = ask(has_counter_, "shutter counter");
  if (!counter) return tl::make_unexpected(counter.error());
  if (*counter != counter_) {
    counter_ = *counter;
    events.push_back({"camera '" + who_ + "': shutter counter " + counter_});
  }
  if (has_clock_) {
    const MonoTime from = clock_.mono();
    const auto shown = session.readClock();
    has_clock_ = shown || has(shown.error());
    if (!shown && has_clock_) return tl::make_unexpected(shown.error());
    if (shown && offset.known() && !offset.observe(*shown, kTick, from, clock_.mono()))
      events.push_back({"camera '" + who_ + "': its clock was set or stands still"});
  }
  if (has_cards_) {
    const auto cards = session.cards();
    has_cards_ = cards || has(cards.error());
    if (!cards && has_cards_) return tl::make_unexpected(cards.error());
    bool low = false;
    std::uint64_t free_bytes = 0;
    for (const CardSpace& card : cards ? *cards : std::vector<CardSpace>{}) {
      low |= card.free_bytes < kCardLowBytes;
      free_bytes += card.free_bytes;
    }
    if (low && !card_low_)
      events.push_back({"camera '" + who_ + "': its card is nearly full, " +
                        formatBytes(free_bytes) + " left: delete what is not Patina's"});
    card_low_ = low;
  }
  return events;
}

bool measureClock(Session& session, ClockOffset& offset, Clock& clock) {
  const MonoTime begun = clock.mono();
  const auto wellKnown = [&] { return offset.known() && offset.width(clock.mono()) <= kKnownWell; };
  std::optional<UtcTime> first;
  while (clock.mono() - begun < kTick + 300ms) {
    const MonoTime from = clock.mono();
    const auto shown = session.readClock();
    if (!shown) {
      const Errc code = shown.error().code;
      if (code != Errc::kBusy && code != Errc::kCorrupt) return false;
      clock.sleepUntil(clock.mono() + kPause, {});
      continue;
    }
    if (!first) first = *shown;
    if (!offset.observe(*shown, kTick, from, clock.mono()) && *shown == *first &&
        clock.mono() - begun > kTick)
      break;
    if (wellKnown()) return true;
    clock.sleepUntil(clock.mono() + kPause, {});
  }
  if (offset.known() && offset.width(clock.mono()) < kTick) return true;
  offset = ClockOffset{};
  return false;
}

}  // namespace patina::devices::gphoto2
