// SPDX-License-Identifier: GPL-3.0-or-later
// A folder that looks like /, with sensors in its sysfs.
#pragma once

#include <map>
#include <string>

#include "tests/support/temp_folder.h"

namespace patina::testing {

using Files = std::map<std::string, std::string>;

class SysfsTree {
 public:
  // `bus` as in "i2c-1/1-0039"; `number` of iio:device.
  void addIio(int number, const std::string& bus, const Files& files) {
    add("sys/devices/platform/" + bus + "/iio:device" + std::to_string(number),
        "sys/bus/iio/devices/iio:device" + std::to_string(number), files);
  }
  void addHwmon(int number, const std::string& bus, const Files& files) {
    add("sys/devices/platform/" + bus + "/hwmon/hwmon" + std::to_string(number),
        "sys/class/hwmon/hwmon" + std::to_string(number), files);
  }
  void remove(const std::string& name) {
    for (const char* top : {"sys/bus/iio/devices/", "sys/class/hwmon/"})
      std::filesystem::remove(folder_ / (top + name));
  }
  void write(const std::string& link, const std::string& file, const std::string& text) {
    writeFile(folder_ / "sys/bus/iio/devices" / link / file, text);
  }
  const std::filesystem::path& root() const { return folder_.path(); }

 private:
  void add(const std::string& real, const std::string& link, const Files& files) {
    std::filesystem::create_directories(folder_ / real);
    for (const auto& [name, text] : files) writeFile(folder_ / real / name, text);
    std::filesystem::create_directories((folder_ / link).parent_path());
    std::filesystem::create_symlink(folder_ / real, folder_ / link);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

}  // namespace patina::testing
