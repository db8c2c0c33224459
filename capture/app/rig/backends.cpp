// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/backends.h"

#include <algorithm>

#include "capture/failure.h"
#include "devices/dmx/artnet_poll.h"
#include "devices/dmx/dmx.h"
#include "devices/gphoto2/gphoto2.h"
#include "devices/gpio/gpio.h"
#include "devices/iio/iio.h"
#include "devices/libcamera/libcamera_devices.h"
#include "devices/network/network.h"
#include "devices/serial/serial.h"
#include "devices/usb/usb.h"
#include "devices/v4l2/v4l2.h"

namespace patina::rig {
namespace {

using std::filesystem::path;
namespace d = devices;

std::vector<Backend> cameras() {
  return {
      {.name = "gphoto2",
       .camera = d::gphoto2::makeCamera,
       .find =
           [] {
             d::RealClock clock;
             return d::gphoto2::find(clock);
           }},
      {.name = "v4l2", .camera = d::v4l2::makeCamera, .find = d::v4l2::find},
      {.name = "libcamera", .camera = d::libcamera::makeCamera, .find = d::libcamera::find},
      {.name = "network", .camera = d::network::makeCamera},
  };
}

// Makers whose last argument a test alone replaces are given its default.
std::vector<Backend> lampsAndSensors() {
  const auto sensor = [](const d::SensorSpec& spec, const path& rig, d::Clock& clock) {
    return d::iio::makeSensor(spec, rig, clock);
  };
  return {
      {.name = "artnet",
       .light = d::dmx::makeLight,
       .find = [] { return d::dmx::find(); },
       .shared_line = d::dmx::sharedLine},
      {.name = "sacn", .light = d::dmx::makeLight, .shared_line = d::dmx::sharedLine},
      {.name = "serial",
       .light = d::serial::makeLight,
       .sensor = d::serial::makeSensor,
       .trigger = d::serial::makeTrigger,
       .find = [] { return d::serial::find(); }},
      {.name = "usb",
       .light = [](const auto& spec, const auto& rig,
                   auto& clock) { return d::usb::makeLight(spec, rig, clock); },
       .trigger = [](const auto& spec, const auto& rig,
                     auto& clock) { return d::usb::makeTrigger(spec, rig, clock); },
       .find = [] { return d::usb::find(); }},
      {.name = "gpio",
       .light = [](const auto& spec, const auto& rig,
                   auto& clock) { return d::gpio::makeLight(spec, rig, clock); },
       .trigger = [](const auto& spec, const auto& rig,
                     auto& clock) { return d::gpio::makeTrigger(spec, rig, clock); },
       .find = d::gpio::find},
      {.name = "iio", .sensor = sensor, .find = [] { return d::iio::find(); }},
      {.name = "hwmon", .sensor = sensor},
  };
}

}  // namespace

const std::vector<Backend>& backends() {
  static const std::vector<Backend> kBackends = [] {
    std::vector<Backend> all = cameras();
    for (Backend& backend : lampsAndSensors()) all.push_back(std::move(backend));
    return all;
  }();
  return kBackends;
}

const Backend* backendNamed(const std::string& name) {
  const auto& all = backends();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Backend& b) { return b.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<devices::FoundDevice> findAttached(const std::string& backend) {
  const Backend* named = backendNamed(backend);
  if (!named) throw capture::CaptureError(Exit::kUsage, "no backend '" + backend + "'");
  return named->find ? named->find() : std::vector<devices::FoundDevice>{};
}

}  // namespace patina::rig
