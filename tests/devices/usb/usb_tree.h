// SPDX-License-Identifier: GPL-3.0-or-later
// A folder that looks like /, with devices on USB.
#pragma once

#include <cstdio>
#include <string>

#include "tests/support/temp_folder.h"

namespace patina::testing {

struct FakeUsb {
  std::string name{};  // "1-1.4"
  int vendor = 0x04a9, product = 0x32d1, number = 5;
  std::string serial{}, model{};
  bool hub = false;
  int speed_mbps = 480;
};

class UsbTree {
 public:
  void add(const FakeUsb& usb) {
    const auto folder = devices() / usb.name;
    std::filesystem::create_directories(folder / "power");
    char hex[8];
    const auto id = [&hex](int v) {
      std::snprintf(hex, sizeof hex, "%04x\n", static_cast<unsigned>(v));
      return std::string(hex);
    };
    const bool root_hub = usb.name.starts_with("usb");
    const std::string bus = root_hub ? usb.name.substr(3) : usb.name.substr(0, usb.name.find('-'));
    writeFile(folder / "idVendor", id(usb.vendor));
    writeFile(folder / "idProduct", id(usb.product));
    writeFile(folder / "busnum", bus + "\n");
    writeFile(folder / "devnum", std::to_string(usb.number) + "\n");
    writeFile(folder / "bDeviceClass", usb.hub ? "09\n" : "00\n");
    writeFile(folder / "speed", std::to_string(usb.speed_mbps) + "\n");
    writeFile(folder / "power/control", "auto\n");
    if (!usb.serial.empty()) writeFile(folder / "serial", usb.serial + "\n");
    if (!usb.model.empty()) writeFile(folder / "product", usb.model + "\n");
    std::filesystem::create_directories(devices() / (usb.name + ":1.0"));
  }
  void remove(const std::string& name) { std::filesystem::remove_all(devices() / name); }
  // Two ports of one connector, as "1-1" port 4 and "2-1" port 4.
  void pair(const std::string& hub, const std::string& other, int port) {
    const auto here = portFolder(hub, port), there = portFolder(other, port);
    std::filesystem::create_directories(here);
    std::filesystem::create_directories(there);
    std::filesystem::create_symlink(there, here / "peer");
    std::filesystem::create_symlink(here, there / "peer");
  }
  // A HID relay board, or with another id something else.
  void addHidraw(int number, const std::string& hid_id = "0003:000016C0:000005DF") {
    const std::string name = "hidraw" + std::to_string(number);
    const auto folder = folder_ / "sys/class/hidraw" / name / "device";
    std::filesystem::create_directories(folder);
    writeFile(folder / "uevent", "DRIVER=hid-generic\nHID_ID=" + hid_id + "\nHID_NAME=x\n");
    std::filesystem::create_directories(root() / "dev");
    writeFile(root() / "dev" / name, "");
  }
  void removeHidraw(int number) {
    std::filesystem::remove_all(folder_ / "sys/class/hidraw" / ("hidraw" + std::to_string(number)));
  }
  const std::filesystem::path& root() const { return folder_.path(); }

 private:
  std::filesystem::path devices() const { return folder_ / "sys/bus/usb/devices"; }
  std::filesystem::path portFolder(const std::string& hub, int port) const {
    const std::string interface = hub.starts_with("usb") ? hub.substr(3) + "-0:1.0" : hub + ":1.0";
    return devices() / interface / (hub + "-port" + std::to_string(port));
  }
  TempFolder folder_ = TempFolder::inMemory();
};

}  // namespace patina::testing
