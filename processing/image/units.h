// SPDX-License-Identifier: GPL-3.0-or-later
// Every number has a unit in its type or its name: these are the types.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

namespace patina {

using Nanoseconds = std::chrono::nanoseconds;

// Wall time, UTC, nanoseconds since 1970. May jump (NTP, an operator): for people and file names.
using UtcTime = std::chrono::sys_time<Nanoseconds>;

// CLOCK_BOOTTIME: nanoseconds since this boot, counting suspend. Never jumps: for intervals.
struct BootTimeline {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = Nanoseconds;
  using time_point = std::chrono::time_point<BootTimeline, Nanoseconds>;
  static constexpr bool is_steady = true;
};
using MonoTime = BootTimeline::time_point;

struct Stops {
  double value = 0;
  auto operator<=>(const Stops&) const = default;
};
struct Iso {
  double value = 100;
  auto operator<=>(const Iso&) const = default;
};
struct FNumber {
  double value = 8;
  auto operator<=>(const FNumber&) const = default;
};
struct Lux {
  double value = 0;
  auto operator<=>(const Lux&) const = default;
};
struct Celsius {
  double value = 20;
  auto operator<=>(const Celsius&) const = default;
};
struct SizePx {
  int width = 0, height = 0;
  bool operator==(const SizePx&) const = default;
};
struct RectPx {  // half-open: x <= column < x + width
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const RectPx&) const = default;
};

constexpr std::int64_t toNs(UtcTime t) { return t.time_since_epoch().count(); }
constexpr std::int64_t toNs(MonoTime t) { return t.time_since_epoch().count(); }
constexpr UtcTime utcFromNs(std::int64_t ns) { return UtcTime{Nanoseconds{ns}}; }
constexpr MonoTime monoFromNs(std::int64_t ns) { return MonoTime{Nanoseconds{ns}}; }
constexpr double toSeconds(Nanoseconds d) { return static_cast<double>(d.count()) * 1e-9; }
Nanoseconds fromSeconds(double seconds);  // rounds to the nearest nanosecond

// Text forms. All parse* throw ProcessingError(kUsage) with the text and the accepted forms.
Nanoseconds parseDuration(std::string_view text);  // "50ms" "10min" "36h" "7d" "1h30min"
std::string formatDuration(Nanoseconds d);         // shortest exact form parseDuration accepts
Nanoseconds parseExposure(std::string_view text);  // "1/100" "0.5s" "20ms"
std::string formatExposure(Nanoseconds d);         // "1/100" where exact, else "0.5s"
SizePx parseSize(std::string_view text);           // "1024x768": width x height
UtcTime parseUtc(std::string_view text);           // "2024-05-01T12:00:00[.fraction]Z", date alone
std::string formatUtc(UtcTime t);                  // "2024-05-01T12:00:00.000Z"
std::string formatUtcCompact(UtcTime t);           // "20240501T120000Z", for ids and file names
std::uint64_t parseBytes(std::string_view text);   // "2GB" "500MiB" "4096"
std::string formatBytes(std::uint64_t bytes);      // "1.5 GB", for people

}  // namespace patina
