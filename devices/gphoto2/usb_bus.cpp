// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/usb_bus.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <fstream>

namespace patina::devices::gphoto2 {

namespace fs = std::filesystem;

namespace {

std::string firstLineOf(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

struct BusPlace {
  int bus = 0, device = 0;
};

std::optional<BusPlace> placeOf(const std::string& port) {
  if (!port.starts_with("usb:")) return std::nullopt;
  char* end = nullptr;
  BusPlace place;
  place.bus = static_cast<int>(std::strtol(port.c_str() + 4, &end, 10));
  if (*end != ',') return std::nullopt;
  place.device = static_cast<int>(std::strtol(end + 1, &end, 10));
  if (*end != '\0' || place.bus < 1 || place.device < 1) return std::nullopt;
  return place;
}

std::string threeDigits(int v) {
  const std::string digits = std::to_string(v);
  return std::string(digits.size() < 3 ? 3 - digits.size() : 0, '0') + digits;
}

// The kernel cuts program names at 15 letters.
struct Grabber {
  const char* begins;
  const char* how_to_stop;
};
constexpr std::array kGrabbers{
    Grabber{"gvfsd-gphoto2",
            "run `gio mount -s gphoto2`; the udev rule of packaging/udev keeps it away"},
    Grabber{"gvfs-gphoto2-vo",
            "run `systemctl --user mask --now gvfs-gphoto2-volume-monitor`; the udev rule of "
            "packaging/udev keeps it away"},
    Grabber{"gphoto2", "end that gphoto2"},
    Grabber{"entangle", "close Entangle"},
    Grabber{"darktable", "close darktable's tethering view"},
    Grabber{"digikam", "close digiKam"},
    Grabber{"shotwell", "close Shotwell"},
    Grabber{"indi_gphoto", "stop the INDI server"}};

const Grabber* grabberOf(const std::string& program) {
  const auto found = std::find_if(kGrabbers.begin(), kGrabbers.end(), [&](const Grabber& grabber) {
    return program.starts_with(grabber.begins);
  });
  return found == kGrabbers.end() ? nullptr : &*found;
}

bool holds(const fs::path& process, const fs::path& node) {
  std::error_code ignored;
  for (fs::directory_iterator fd(process / "fd", ignored), end; !ignored && fd != end;
       fd.increment(ignored)) {
    std::error_code gone;
    if (fs::read_symlink(fd->path(), gone) == node) return true;
  }
  return false;
}

}  // namespace

std::optional<fs::path> usbNode(const std::string& port) {
  const auto place = placeOf(port);
  if (!place) return std::nullopt;
  return fs::path("/dev/bus/usb") / threeDigits(place->bus) / threeDigits(place->device);
}

std::string usbSerial(const std::string& port, const fs::path& sysfs) {
  const auto place = placeOf(port);
  if (!place) return "";
  std::error_code ignored;
  for (fs::directory_iterator device(sysfs, ignored), end; !ignored && device != end;
       device.increment(ignored)) {
    if (firstLineOf(device->path() / "busnum") == std::to_string(place->bus) &&
        firstLineOf(device->path() / "devnum") == std::to_string(place->device))
      return firstLineOf(device->path() / "serial");
  }
  return "";
}

bool mayOpen(const fs::path& node) { return ::access(node.c_str(), R_OK | W_OK) == 0; }

std::vector<Holder> holdersOf(const fs::path& node, const fs::path& proc) {
  std::vector<Holder> holders, suspects;
  std::error_code ignored;
  for (fs::directory_iterator process(proc, ignored), end; !ignored && process != end;
       process.increment(ignored)) {
    const std::string number = process->path().filename();
    if (!std::all_of(number.begin(), number.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; }))
      continue;
    Holder holder;
    holder.pid = static_cast<int>(std::strtol(number.c_str(), nullptr, 10));
    if (holder.pid == ::getpid()) continue;
    holder.name = firstLineOf(process->path() / "comm");
    const Grabber* grabber = grabberOf(holder.name);
    holder.how_to_stop = grabber ? grabber->how_to_stop : "end it, or let it go of the camera";
    if (holds(process->path(), node))
      holders.push_back(holder);
    else if (grabber && ::access((process->path() / "fd").c_str(), R_OK) != 0)
      suspects.push_back(holder);
  }
  return holders.empty() ? suspects : holders;
}

std::string describe(const std::vector<Holder>& holders) {
  std::string text;
  for (const Holder& holder : holders)
    text += (text.empty() ? "" : "; ") + holder.name + " (pid " + std::to_string(holder.pid) +
            "): " + holder.how_to_stop;
  return text.empty() ? "a process of another user: `sudo fuser -v` on its node names it" : text;
}

}  // namespace patina::devices::gphoto2
