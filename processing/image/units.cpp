// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/units.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "processing/image/failure.h"

namespace patina {
namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t kNsMax = std::numeric_limits<std::int64_t>::max();

struct Unit {
  std::string_view name;
  std::int64_t ns;
};
constexpr std::array<Unit, 7> kUnits{{{"d", 86'400'000'000'000},
                                      {"h", 3'600'000'000'000},
                                      {"min", 60'000'000'000},
                                      {"s", 1'000'000'000},
                                      {"ms", 1'000'000},
                                      {"us", 1'000},
                                      {"ns", 1}}};

// Text of the user inside a message: short, and one line whatever it holds.
std::string quoted(std::string_view text) {
  std::string out = "'";
  for (char c : text.substr(0, 40)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > 40 ? "...'" : "'");
}

[[noreturn]] void refuse(std::string_view what, std::string_view text, std::string_view why) {
  throw ProcessingError(Exit::kUsage,
                        std::string(what) + " " + quoted(text) + ": " + std::string(why));
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Non-negative decimal: mantissa / 10^decimals. At most 20 digits, so that products fit in Wide.
struct Decimal {
  Wide mantissa = 0;
  int decimals = 0;
};

// Takes digits[.digits] off the front of `rest`; nothing when there is none or it is too long.
std::optional<Decimal> takeDecimal(std::string_view& rest) {
  Decimal value;
  std::size_t i = 0;
  int digits = 0;
  bool point = false;
  for (; i < rest.size(); ++i) {
    if (rest[i] == '.' && !point && i > 0) {
      point = true;
      continue;
    }
    if (!isDigit(rest[i])) break;
    if (++digits > 20) return std::nullopt;
    value.mantissa = value.mantissa * 10 + (rest[i] - '0');
    value.decimals += point ? 1 : 0;
  }
  if (digits == 0 || rest[i - 1] == '.') return std::nullopt;
  rest.remove_prefix(i);
  return value;
}

std::string_view takeLetters(std::string_view& rest) {
  std::size_t n = 0;
  while (n < rest.size() && isLetter(rest[n])) ++n;
  const std::string_view letters = rest.substr(0, n);
  rest.remove_prefix(n);
  return letters;
}

Wide powerOfTen(int exponent) {
  Wide p = 1;
  for (int i = 0; i < exponent; ++i) p *= 10;
  return p;
}

constexpr std::string_view kDurationForms =
    "expected a duration such as 50ms, 5s, 10min, 36h, 7d or 1h30min (units ns us ms s min h d)";

std::optional<std::size_t> findUnit(std::string_view name) {
  for (std::size_t i = 0; i < kUnits.size(); ++i)
    if (kUnits[i].name == name) return i;
  return std::nullopt;
}

std::string decimalSeconds(std::int64_t ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(ns / 1'000'000'000),
                static_cast<long long>(ns % 1'000'000'000));
  std::string out = text;
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  return out + "s";
}

}  // namespace

Nanoseconds fromSeconds(double seconds) {
  const double ns = std::round(seconds * 1e9);
  if (!(std::abs(ns) < 9.2e18)) {
    throw ProcessingError(Exit::kUsage, "a time of " + std::to_string(seconds) +
                                            " s does not fit: at most about 292 years");
  }
  return Nanoseconds{static_cast<std::int64_t>(ns)};
}

Nanoseconds parseDuration(std::string_view text) {
  std::string_view rest = text;
  std::size_t smallest_allowed = 0;
  Wide total = 0;
  if (rest.empty()) refuse("duration", text, kDurationForms);
  if (rest[0] == '-') refuse("duration", text, "must not be negative");
  while (!rest.empty()) {
    const auto value = takeDecimal(rest);
    if (!value) refuse("duration", text, kDurationForms);
    const std::string_view name = takeLetters(rest);
    if (name == "m" || name == "M")
      refuse("duration", text, "'m' could be minutes or milliseconds; write min or ms");
    if (name.empty() && rest.empty())
      refuse("duration", text, "the unit is missing; write for example 10min, 5s or 36h");
    const auto unit = findUnit(name);
    if (!unit) refuse("duration", text, kDurationForms);
    if (*unit < smallest_allowed)
      refuse("duration", text, "each unit at most once and the largest first, as in 1h30min");
    smallest_allowed = *unit + 1;
    const Wide scaled = value->mantissa * kUnits[*unit].ns;
    if (scaled % powerOfTen(value->decimals) != 0)
      refuse("duration", text, "is finer than one nanosecond");
    total += scaled / powerOfTen(value->decimals);
    if (total > kNsMax) refuse("duration", text, "is too long: at most about 292 years");
  }
  return Nanoseconds{static_cast<std::int64_t>(total)};
}

std::string formatDuration(Nanoseconds d) {
  if (d.count() == 0) return "0s";
  const bool negative = d.count() < 0;
  // Unsigned, because the lowest count has no positive twin.
  const std::uint64_t ns =
      negative ? 0 - static_cast<std::uint64_t>(d.count()) : static_cast<std::uint64_t>(d.count());
  std::string single, compound;
  std::uint64_t rest = ns;
  for (const Unit& unit : kUnits) {
    const auto size = static_cast<std::uint64_t>(unit.ns);
    if (single.empty() && ns % size == 0) single = std::to_string(ns / size).append(unit.name);
    if (rest >= size) compound += std::to_string(rest / size).append(unit.name);
    rest %= size;
  }
  return (negative ? "-" : "") + (compound.size() < single.size() ? compound : single);
}

Nanoseconds parseExposure(std::string_view text) {
  constexpr std::string_view kForms = "expected an exposure such as 1/100, 0.5s or 20ms";
  const auto slash = text.find('/');
  if (slash == std::string_view::npos) {
    Nanoseconds d{0};
    try {
      d = parseDuration(text);
    } catch (const ProcessingError&) {
      refuse("exposure", text, kForms);
    }
    if (d.count() <= 0) refuse("exposure", text, "must be longer than nothing");
    return d;
  }
  std::string_view rest = text;
  const auto above = takeDecimal(rest);
  if (!above || rest.empty() || rest[0] != '/') refuse("exposure", text, kForms);
  rest.remove_prefix(1);
  const auto below = takeDecimal(rest);
  if (!below || !(rest.empty() || rest == "s")) refuse("exposure", text, kForms);
  if (below->mantissa == 0 || above->mantissa == 0)
    refuse("exposure", text, "must be longer than nothing and finite");
  const double seconds = (static_cast<double>(above->mantissa) * std::pow(10.0, -above->decimals)) /
                         (static_cast<double>(below->mantissa) * std::pow(10.0, -below->decimals));
  if (!(seconds <= 86400.0 * 365)) refuse("exposure", text, "is longer than a year");
  const Nanoseconds d = fromSeconds(seconds);
  if (d.count() <= 0) refuse("exposure", text, "is shorter than one nanosecond");
  return d;
}

std::string formatExposure(Nanoseconds d) {
  const std::int64_t ns = d.count();
  if (ns < 0) return "-" + formatExposure(Nanoseconds{ns == -kNsMax - 1 ? kNsMax : -ns});
  if (ns > 0 && ns <= 250'000'000) {  // slower shutters are written in seconds on cameras
    const std::int64_t n = (1'000'000'000 + ns / 2) / ns;
    if (n <= 100'000 && (1'000'000'000 + n / 2) / n == ns) return "1/" + std::to_string(n);
  }
  return decimalSeconds(ns);
}

SizePx parseSize(std::string_view text) {
  constexpr std::string_view kForms =
      "expected WIDTHxHEIGHT in pixels, each from 1 to 1000000, such as 1024x768";
  std::string_view rest = text;
  const auto number = [&] {
    const auto value = takeDecimal(rest);
    if (!value || value->decimals != 0 || value->mantissa < 1 || value->mantissa > 1'000'000)
      refuse("size", text, kForms);
    return static_cast<int>(value->mantissa);
  };
  SizePx size;
  size.width = number();
  if (rest.empty() || rest[0] != 'x') refuse("size", text, kForms);
  rest.remove_prefix(1);
  size.height = number();
  if (!rest.empty()) refuse("size", text, kForms);
  return size;
}

std::uint64_t parseBytes(std::string_view text) {
  constexpr std::string_view kForms = "expected bytes such as 4096, 500MB, 2GB or 500MiB";
  static constexpr std::array<std::pair<std::string_view, std::int64_t>, 11> kSizes{{
      {"", 1},
      {"B", 1},
      {"kB", 1'000},
      {"KB", 1'000},
      {"MB", 1'000'000},
      {"GB", 1'000'000'000},
      {"TB", 1'000'000'000'000},
      {"KiB", 1ll << 10},
      {"MiB", 1ll << 20},
      {"GiB", 1ll << 30},
      {"TiB", 1ll << 40},
  }};
  std::string_view rest = text;
  const auto value = takeDecimal(rest);
  if (!value) refuse("size in bytes", text, kForms);
  if (!rest.empty() && rest[0] == ' ') rest.remove_prefix(1);
  for (const auto& [name, factor] : kSizes) {
    if (rest != name) continue;
    const Wide bytes = value->mantissa * factor / powerOfTen(value->decimals);
    if (bytes > kNsMax) refuse("size in bytes", text, "is too large");
    return static_cast<std::uint64_t>(bytes);
  }
  refuse("size in bytes", text, kForms);
}

std::string formatBytes(std::uint64_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " B";
  static constexpr const char* kNames[] = {"kB", "MB", "GB", "TB", "PB", "EB"};
  double value = static_cast<double>(bytes) / 1000.0;
  int i = 0;
  while (value >= 999.5 && i < 5) {
    value /= 1000.0;
    ++i;
  }
  char text[40];
  std::snprintf(text, sizeof text, value < 9.95 ? "%.1f %s" : "%.0f %s", value, kNames[i]);
  return text;
}

}  // namespace patina
