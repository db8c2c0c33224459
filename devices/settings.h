// SPDX-License-Identifier: GPL-3.0-or-later
// The settings of one device in the rig file, each checked by its backend.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::devices {

// Every take* marks its key as known; finish() throws for one that nobody took. All throw
// ConfigError naming file, device, key and what is allowed.
class Settings {
 public:
  Settings(const std::map<std::string, std::string>& values, std::string device,
           std::filesystem::path source);

  std::string takeChoice(const std::string& key, const std::vector<std::string>& choices);  // first
  std::string takeText(const std::string& key, const std::string& fallback);
  // All keys that begin so, without the prefix.
  std::map<std::string, std::string> takePrefixed(const std::string& prefix);
  int takeInteger(const std::string& key, int least, int most, int fallback);
  double takeNumber(const std::string& key, double least, double most, double fallback);
  Nanoseconds takeDuration(const std::string& key, Nanoseconds least, Nanoseconds most,
                           Nanoseconds fallback);
  Nanoseconds takeExposure(const std::string& key, Nanoseconds fallback);
  std::array<double, 3> takePosition(const std::string& key, std::array<double, 3> fallback);
  void finish() const;
  [[noreturn]] void reject(const std::string& key, const std::string& problem) const;

 private:
  const std::string* find(const std::string& key);

  const std::map<std::string, std::string>& values_;
  std::set<std::string> known_;
  std::string device_;
  std::filesystem::path source_;
};

}  // namespace patina::devices
