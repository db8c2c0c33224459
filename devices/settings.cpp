// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/settings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "devices/config_file.h"

namespace patina::devices {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string text(double v) {
  std::ostringstream out;
  out << v;
  return out.str();
}

// The whole text as a number, or NaN.
double numberOf(const std::string& text) {
  char* end = nullptr;
  const double v = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? v : std::nan("");
}

}  // namespace

Settings::Settings(const std::map<std::string, std::string>& values, std::string device,
                   std::filesystem::path source)
    : values_(values), device_(std::move(device)), source_(std::move(source)) {}

const std::string* Settings::find(const std::string& key) {
  known_.insert(key);
  const auto it = values_.find(key);
  return it == values_.end() ? nullptr : &it->second;
}

void Settings::reject(const std::string& key, const std::string& problem) const {
  throw ConfigError(source_, 0, device_ + ": settings." + key, problem);
}

std::string Settings::takeChoice(const std::string& key, const std::vector<std::string>& choices) {
  const std::string* value = find(key);
  if (!value) return choices.front();
  if (std::find(choices.begin(), choices.end(), *value) == choices.end())
    reject(key, "'" + *value + "' is none of " + joined(choices));
  return *value;
}

std::string Settings::takeText(const std::string& key, const std::string& fallback) {
  const std::string* value = find(key);
  return value ? *value : fallback;
}

std::map<std::string, std::string> Settings::takePrefixed(const std::string& prefix) {
  std::map<std::string, std::string> taken;
  for (const auto& [key, value] : values_) {
    if (!key.starts_with(prefix) || key == prefix) continue;
    known_.insert(key);
    taken.emplace(key.substr(prefix.size()), value);
  }
  known_.insert(prefix + "NAME");
  return taken;
}

int Settings::takeInteger(const std::string& key, int least, int most, int fallback) {
  const double v = takeNumber(key, least, most, fallback);
  if (v != std::floor(v)) reject(key, text(v) + " is not a whole number");
  return static_cast<int>(v);
}

double Settings::takeNumber(const std::string& key, double least, double most, double fallback) {
  const std::string* value = find(key);
  if (!value) return fallback;
  const double v = numberOf(*value);
  if (!(v >= least && v <= most))
    reject(key, "'" + *value + "' is out of range (" + text(least) + " to " + text(most) + ")");
  return v;
}

Nanoseconds Settings::takeDuration(const std::string& key, Nanoseconds least, Nanoseconds most,
                                   Nanoseconds fallback) {
  const std::string* value = find(key);
  if (!value) return fallback;
  Nanoseconds duration{};
  try {
    duration = parseDuration(*value);
  } catch (const Failure& problem) {
    reject(key, problem.what());
  }
  if (duration < least || duration > most)
    reject(key, *value + " is out of range (" + formatDuration(least) + " to " +
                    formatDuration(most) + ")");
  return duration;
}

Nanoseconds Settings::takeExposure(const std::string& key, Nanoseconds fallback) {
  const std::string* value = find(key);
  if (!value) return fallback;
  try {
    return parseExposure(*value);
  } catch (const Failure& problem) {
    reject(key, problem.what());
  }
}

std::array<double, 3> Settings::takePosition(const std::string& key,
                                             std::array<double, 3> fallback) {
  const std::string* value = find(key);
  if (!value) return fallback;
  std::istringstream in(*value);
  std::array<double, 3> position{};
  for (double& coordinate : position) {
    std::string part;
    std::getline(in, part, ',');
    coordinate = numberOf(part);
    if (!(std::abs(coordinate) <= 1e5)) reject(key, "'" + *value + "' is not \"x,y,z\" in mm");
  }
  return position;
}

void Settings::finish() const {
  for (const auto& [key, value] : values_)
    if (!known_.contains(key))
      reject(key, "unknown; there are: " + joined({known_.begin(), known_.end()}));
}

}  // namespace patina::devices
