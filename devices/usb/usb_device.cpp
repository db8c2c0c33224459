// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/usb_device.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace fs = std::filesystem;

namespace patina::devices::usb {
namespace {

constexpr int kHubClass = 9;
constexpr int kSuperspeedMbps = 5000;

std::string attribute(const fs::path& device, const char* name) {
  std::ifstream file(device / name);
  std::string text;
  std::getline(file, text);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}
int number(const fs::path& device, const char* name, int base) {
  return static_cast<int>(std::strtol(attribute(device, name).c_str(), nullptr, base));
}

std::string joined(const std::vector<UsbDevice>& devices) {
  std::string text;
  for (const UsbDevice& d : devices) text += (text.empty() ? "" : ", ") + d.describe();
  return text.empty() ? "nothing" : text;
}

std::string idText(int vendor, int product) {
  char text[16];
  std::snprintf(text, sizeof text, "%04x:%04x", static_cast<unsigned>(vendor),
                static_cast<unsigned>(product));
  return text;
}

}  // namespace

fs::path UsbDevice::node() const {
  char text[40];
  std::snprintf(text, sizeof text, "dev/bus/usb/%03d/%03d", bus, this->number);
  return text;
}

std::string UsbDevice::describe() const {
  return (model.empty() ? idText(vendor, product) : model) +
         (serial.empty() ? "" : " serial " + serial) + " (" + name + ")";
}

std::vector<UsbDevice> attached(const fs::path& root) {
  std::vector<UsbDevice> devices;
  std::error_code error;
  for (fs::directory_iterator it(root / "sys/bus/usb/devices", error), end; !error && it != end;
       it.increment(error)) {
    const fs::path& path = it->path();
    UsbDevice device;
    device.name = path.filename();
    if (device.name.find(':') != std::string::npos) continue;  // an interface
    device.vendor = number(path, "idVendor", 16);
    device.product = number(path, "idProduct", 16);
    device.bus = number(path, "busnum", 10);
    device.number = number(path, "devnum", 10);
    device.serial = attribute(path, "serial");
    device.model = attribute(path, "product");
    device.is_hub = number(path, "bDeviceClass", 16) == kHubClass;
    device.superspeed = number(path, "speed", 10) >= kSuperspeedMbps;
    device.may_suspend = attribute(path, "power/control") == "auto";
    if (device.number > 0) devices.push_back(std::move(device));
  }
  std::ranges::sort(devices, {}, &UsbDevice::name);
  return devices;
}

Result<UsbDevice> findDevice(const UsbIdentity& wanted, const fs::path& root) {
  const auto all = attached(root);
  std::vector<UsbDevice> fits, others;
  for (const UsbDevice& d : all) {
    const bool kind = (wanted.vendor == 0 || d.vendor == wanted.vendor) &&
                      (wanted.product == 0 || d.product == wanted.product);
    if (kind && (wanted.serial.empty() || d.serial == wanted.serial))
      fits.push_back(d);
    else if (!d.is_hub)
      others.push_back(d);
  }
  if (fits.size() == 1) return fits.front();
  const std::string who = "USB device " + idText(wanted.vendor, wanted.product) +
                          (wanted.serial.empty() ? "" : " serial " + wanted.serial);
  if (fits.empty())
    return fail(Errc::kLost, who + " is not attached; there are: " + joined(others));
  return fail(Errc::kRefused, who + " fits several, name one by its serial: " + joined(fits));
}

}  // namespace patina::devices::usb
