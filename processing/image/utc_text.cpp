// SPDX-License-Identifier: GPL-3.0-or-later
// The text forms of UTC in units.h.
#include <cstdio>

#include "processing/image/failure.h"
#include "processing/image/units.h"

namespace patina {
namespace {

// Takes fixed-width numbers and punctuation off the front of a text.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : rest_(text) {}
  bool done() const { return rest_.empty(); }

  bool number(int width, int& value) {
    if (rest_.size() < static_cast<std::size_t>(width)) return false;
    value = 0;
    for (int i = 0; i < width; ++i) {
      if (rest_[i] < '0' || rest_[i] > '9') return false;
      value = value * 10 + (rest_[i] - '0');
    }
    rest_.remove_prefix(width);
    return true;
  }
  bool symbol(char c) {
    if (rest_.empty() || rest_[0] != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  // Digits after the point, to nanoseconds; further digits are dropped.
  bool fraction(std::int64_t& ns) {
    std::int64_t unit = 100'000'000;
    ns = 0;
    std::size_t n = 0;
    for (; n < rest_.size() && rest_[n] >= '0' && rest_[n] <= '9'; ++n, unit /= 10)
      ns += (rest_[n] - '0') * unit;
    rest_.remove_prefix(n);
    return n > 0;
  }

 private:
  std::string_view rest_;
};

struct Fields {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  int offset_min = 0;
  std::int64_t ns = 0;
};

bool readOffset(Cursor& in, Fields& f) {
  if (in.symbol('Z') || in.done()) return true;
  const bool east = in.symbol('+');
  if (!east && !in.symbol('-')) return false;
  int hours = 0, minutes = 0;
  if (!in.number(2, hours) || !in.symbol(':') || !in.number(2, minutes)) return false;
  if (hours > 14 || minutes > 59) return false;
  f.offset_min = (east ? 1 : -1) * (hours * 60 + minutes);
  return true;
}

bool readFields(std::string_view text, Fields& f) {
  Cursor in(text);
  if (!in.number(4, f.year) || !in.symbol('-') || !in.number(2, f.month) || !in.symbol('-') ||
      !in.number(2, f.day))
    return false;
  if (in.done()) return true;
  if (!in.symbol('T') && !in.symbol(' ')) return false;
  if (!in.number(2, f.hour) || !in.symbol(':') || !in.number(2, f.minute)) return false;
  if (in.symbol(':')) {
    if (!in.number(2, f.second)) return false;
    if (in.symbol('.') && !in.fraction(f.ns)) return false;
  }
  return readOffset(in, f) && in.done();
}

struct Calendar {
  int year;
  unsigned month, day;
  int hour, minute, second, ms;
};

Calendar calendarOf(UtcTime t) {
  const auto day = std::chrono::floor<std::chrono::days>(t);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(t - day);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time.subseconds());
  return {static_cast<int>(date.year()),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<int>(time.hours().count()),
          static_cast<int>(time.minutes().count()),
          static_cast<int>(time.seconds().count()),
          static_cast<int>(ms.count())};
}

}  // namespace

UtcTime parseUtc(std::string_view text) {
  Fields f;
  const auto refuse = [&](const std::string& why) {
    std::string shown(text.substr(0, 40));
    for (char& c : shown)
      if (c < ' ' || c > '~') c = '?';
    throw ProcessingError(Exit::kUsage, "time '" + shown + "': " + why);
  };
  if (!readFields(text, f))
    refuse("expected UTC such as 2024-05-01T12:00:00Z, 2024-05-01T12:00:00.250Z or 2024-05-01");
  const std::chrono::year_month_day date{std::chrono::year{f.year},
                                         std::chrono::month{static_cast<unsigned>(f.month)},
                                         std::chrono::day{static_cast<unsigned>(f.day)}};
  if (f.year < 1700 || f.year > 2250) refuse("the year must be from 1700 to 2250");
  if (!date.ok() || f.hour > 23 || f.minute > 59 || f.second > 59)
    refuse("there is no such day or hour");
  return UtcTime{std::chrono::sys_days{date}} + std::chrono::hours{f.hour} +
         std::chrono::minutes{f.minute - f.offset_min} + std::chrono::seconds{f.second} +
         Nanoseconds{f.ns};
}

std::string formatUtc(UtcTime t) {
  const Calendar c = calendarOf(t);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", c.year, c.month, c.day,
                c.hour, c.minute, c.second, c.ms);
  return text;
}

std::string formatUtcCompact(UtcTime t) {
  const Calendar c = calendarOf(t);
  char text[64];
  std::snprintf(text, sizeof text, "%04d%02u%02uT%02d%02d%02dZ", c.year, c.month, c.day, c.hour,
                c.minute, c.second);
  return text;
}

}  // namespace patina
