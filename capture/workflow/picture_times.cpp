// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/picture_times.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace patina::workflow {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

struct Digits {
  std::size_t begin = 0;
  std::string_view text;
  std::size_t end() const { return begin + text.size(); }
};

std::vector<Digits> digitRuns(std::string_view name) {
  std::vector<Digits> runs;
  for (std::size_t i = 0; i < name.size();) {
    if (!isDigit(name[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < name.size() && isDigit(name[end])) ++end;
    runs.push_back({i, name.substr(i, end - i)});
    i = end;
  }
  return runs;
}

int number(std::string_view digits) {
  int value = 0;
  for (const char c : digits) value = value * 10 + (c - '0');
  return value;
}

std::optional<UtcTime> dayOf(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (year < 1970 || year > 2099 || !date.ok()) return std::nullopt;
  return UtcTime{std::chrono::sys_days(date)};
}

// Of "HHMM", "HHMMSS" or "HHMMSSmmm"; nothing when the digits cannot be a time of day.
std::optional<Nanoseconds> timeOfDay(std::string_view digits) {
  if (digits.size() != 2 && digits.size() != 4 && digits.size() != 6 && digits.size() != 9)
    return std::nullopt;
  const int hour = number(digits.substr(0, 2));
  const int minute = digits.size() >= 4 ? number(digits.substr(2, 2)) : 0;
  const int second = digits.size() >= 6 ? number(digits.substr(4, 2)) : 0;
  const int millisecond = digits.size() == 9 ? number(digits.substr(6, 3)) : 0;
  if (hour > 23 || minute > 59 || second > 59) return std::nullopt;
  return std::chrono::hours(hour) + std::chrono::minutes(minute) + std::chrono::seconds(second) +
         std::chrono::milliseconds(millisecond);
}

// The time of day that follows a date which ends at `end`; zero when there is none.
Nanoseconds timeAfter(std::string_view name, const std::vector<Digits>& runs, std::size_t next,
                      std::size_t end) {
  constexpr std::string_view kBetween = "-_ .:,Tth";
  std::string joined;
  for (; next < runs.size() && joined.size() < 6; ++next) {
    const std::string_view gap = name.substr(end, runs[next].begin - end);
    if (gap.empty() || gap.size() > 2 || gap.find_first_not_of(kBetween) != std::string_view::npos)
      break;
    if (runs[next].text.size() != 2 && !joined.empty()) break;
    joined += runs[next].text;
    end = runs[next].end();
  }
  return timeOfDay(joined).value_or(Nanoseconds{});
}

std::optional<UtcTime> dateAt(std::string_view name, const std::vector<Digits>& runs,
                              std::size_t i) {
  const std::string_view text = runs[i].text;
  if (text.size() >= 8) {
    const auto day =
        dayOf(number(text.substr(0, 4)), number(text.substr(4, 2)), number(text.substr(6, 2)));
    if (!day) return std::nullopt;
    if (text.size() == 8) return *day + timeAfter(name, runs, i + 1, runs[i].end());
    const auto time = timeOfDay(text.substr(8));
    return time ? std::optional<UtcTime>(*day + *time) : std::nullopt;
  }
  if (text.size() != 4 || i + 2 >= runs.size()) return std::nullopt;
  for (const std::size_t k : {i + 1, i + 2})
    if (runs[k].text.size() > 2 || runs[k].begin != runs[k - 1].end() + 1) return std::nullopt;
  const auto day = dayOf(number(text), number(runs[i + 1].text), number(runs[i + 2].text));
  if (!day) return std::nullopt;
  return *day + timeAfter(name, runs, i + 3, runs[i + 2].end());
}

std::optional<UtcTime> unixTime(std::string_view digits) {
  if (digits.size() != 10 && digits.size() != 13) return std::nullopt;
  std::int64_t value = 0;
  for (const char c : digits) value = value * 10 + (c - '0');
  // Nanoseconds do not hold every thirteen digits.
  const std::chrono::sys_time<std::chrono::milliseconds> time{
      std::chrono::milliseconds(digits.size() == 10 ? value * 1000 : value)};
  const bool plausible = time >= std::chrono::sys_days(std::chrono::year(1990) / 1 / 1) &&
                         time < std::chrono::sys_days(std::chrono::year(2099) / 1 / 1);
  return plausible ? std::optional<UtcTime>(time) : std::nullopt;
}

// "day 3", "Day_03", "hour12": the word right before the digits.
std::optional<UtcTime> countedTime(std::string_view name, const Digits& run, UtcTime origin) {
  if (run.text.size() > 6) return std::nullopt;
  std::size_t end = run.begin;
  while (end > 0 && (name[end - 1] == ' ' || name[end - 1] == '_' || name[end - 1] == '-')) --end;
  std::string word;
  while (end > 0 && std::isalpha(static_cast<unsigned char>(name[end - 1])))
    word.insert(word.begin(), static_cast<char>(std::tolower(name[--end])));
  constexpr int kHoursMax = 100 * 366 * 24;  // nanoseconds hold three centuries
  const int count = number(run.text), hours_each = word == "hour" ? 1 : 24;
  if (word != "hour" && word != "day" && word != "tag") return std::nullopt;
  if (count > kHoursMax / hours_each) return std::nullopt;
  return origin + std::chrono::hours(count * hours_each);
}

}  // namespace

bool naturalLess(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      std::size_t ei = i, ej = j;
      while (ei < a.size() && isDigit(a[ei])) ++ei;
      while (ej < b.size() && isDigit(b[ej])) ++ej;
      std::string_view da = a.substr(i, ei - i), db = b.substr(j, ej - j);
      da.remove_prefix(std::min(da.find_first_not_of('0'), da.size()));
      db.remove_prefix(std::min(db.find_first_not_of('0'), db.size()));
      if (da.size() != db.size()) return da.size() < db.size();
      if (da != db) return da < db;
      i = ei;
      j = ej;
      continue;
    }
    if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    ++i;
    ++j;
  }
  if (i < a.size() || j < b.size()) return i == a.size();
  return a < b;  // "07" and "7": some fixed order
}

std::optional<UtcTime> timeFromName(std::string_view name, UtcTime origin) {
  const std::vector<Digits> runs = digitRuns(name);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (const auto time = dateAt(name, runs, i)) return time;
  for (const Digits& run : runs)
    if (const auto time = unixTime(run.text)) return time;
  for (const Digits& run : runs)
    if (const auto time = countedTime(name, run, origin)) return time;
  return std::nullopt;
}

namespace {

// Mean of the commonest distance (within 10 %), the smaller one of equals; whole seconds where the
// mean is within 1 % of them.
Nanoseconds commonDistance(std::vector<std::int64_t> distances) {
  std::sort(distances.begin(), distances.end());
  std::size_t best = 0;
  double mean = 0;
  for (std::size_t i = 0; i < distances.size();) {
    const double limit = static_cast<double>(distances[i]) * 1.1;
    std::size_t end = i;
    double sum = 0;
    while (end < distances.size() && static_cast<double>(distances[end]) <= limit)
      sum += static_cast<double>(distances[end++]);
    if (end - i > best) {
      best = end - i;
      mean = sum / static_cast<double>(best);
    }
    const std::int64_t value = distances[i];
    while (i < distances.size() && distances[i] == value) ++i;
  }
  const double seconds = std::round(mean * 1e-9);
  if (seconds > 0 && std::abs(seconds * 1e9 - mean) <= 0.01 * mean) mean = seconds * 1e9;
  return Nanoseconds(std::llround(mean));
}

}  // namespace

Rhythm findRhythm(const std::vector<UtcTime>& times) {
  Rhythm rhythm;
  const auto unordered = [&] {
    Rhythm plain;
    for (std::size_t i = 0; i < times.size(); ++i)
      plain.numbers.emplace_back(static_cast<std::int64_t>(i));
    return plain;
  };
  std::vector<std::int64_t> distances;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const std::int64_t distance = (times[i] - times[i - 1]).count();
    if (distance > 0) distances.push_back(distance);
  }
  if (distances.empty()) return unordered();
  rhythm.interval = commonDistance(std::move(distances));
  const double interval = static_cast<double>(rhythm.interval.count());

  std::size_t odd = 0, last = 0;  // `last`: the newest time that has a step
  rhythm.numbers.emplace_back(0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double steps = static_cast<double>((times[i] - times[last]).count()) / interval;
    const double whole = std::round(steps);
    if (whole < 1) {
      ++odd;
      rhythm.numbers.emplace_back(std::nullopt);
      continue;
    }
    if (std::abs(steps - whole) > 0.25) ++odd;
    rhythm.numbers.emplace_back(*rhythm.numbers[last] + static_cast<std::int64_t>(whole));
    last = i;
  }
  if (odd * 20 > times.size()) return unordered();
  rhythm.regular = true;
  return rhythm;
}

}  // namespace patina::workflow
