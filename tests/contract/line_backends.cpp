// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps, triggers and sensors of the real drivers, on simulated other ends.
#include <utility>

#include "devices/dmx/dmx.h"
#include "devices/gpio/gpio.h"
#include "devices/iio/iio.h"
#include "devices/serial/serial.h"
#include "devices/usb/usb.h"
#include "tests/contract/backends.h"
#include "tests/devices/dmx/node.h"
#include "tests/devices/iio/sysfs_tree.h"
#include "tests/devices/serial/pty.h"
#include "tests/devices/usb/fake_board.h"
#include "tests/devices/usb/usb_tree.h"

namespace patina::testing {
namespace {

using namespace patina::devices;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);
constexpr const char* kFile = "rig.toml";

using Values = std::map<std::string, std::string>;

LightSpec lamp(std::string backend, std::string address, Values settings) {
  LightSpec spec;
  spec.id = "key";
  spec.backend = std::move(backend);
  spec.address = std::move(address);
  spec.settings = std::move(settings);
  return spec;
}
TriggerSpec shutter(std::string backend, std::string address, Values settings) {
  TriggerSpec spec;
  spec.id = "shutter";
  spec.backend = std::move(backend);
  spec.address = std::move(address);
  spec.settings = std::move(settings);
  return spec;
}
SensorSpec sensor(std::string id, std::string backend, Quantity quantity, Values settings) {
  SensorSpec spec;
  spec.id = std::move(id);
  spec.backend = std::move(backend);
  spec.quantity = quantity;
  spec.settings = std::move(settings);
  return spec;
}
RigUnderTest onVirtualTime() { return {std::make_unique<VirtualClock>(kStart), {}}; }

RigUnderTest makeDmx(const std::string& backend) {
  RigUnderTest made = onVirtualTime();
  const auto node = std::make_shared<Node>();
  made.world = node;
  made.rig.lights.push_back(dmx::makeLight(
      lamp(backend, "127.0.0.1", {{"port", std::to_string(node->port())}}), kFile, *made.clock));
  return made;
}

// A board with a relay, a sensor that is asked and a shutter.
RigUnderTest makeSerial() {
  RigUnderTest made = onVirtualTime();
  const auto lit = std::make_shared<bool>(false);
  const auto board = std::make_shared<Pty>([lit](const std::string& line) -> std::string {
    if (line == "L1" || line == "L0") *lit = line == "L1";
    if (line == "L?") return *lit ? "L=1\n" : "L=0\n";
    if (line == "T?") return "T=21.5\n";
    if (line == "FIRE") return "OK\n";
    return "";
  });
  made.world = board;
  const std::string port = board->path();
  made.rig.lights.push_back(serial::makeLight(lamp("serial", port,
                                                   {{"on", "L1\\n"},
                                                    {"off", "L0\\n"},
                                                    {"ask", "L?\\n"},
                                                    {"ask_on", "L=1"},
                                                    {"ask_off", "L=0"},
                                                    {"timeout", "10s"}}),
                                              kFile, *made.clock));
  made.rig.sensors.push_back(serial::makeSensor(
      sensor("air0", "serial", Quantity::kTemperature,
             {{"port", port}, {"ask", "T?\\n"}, {"pattern", "T={value}"}, {"max_age", "10s"}}),
      kFile, *made.clock));
  made.rig.triggers.push_back(serial::makeTrigger(
      shutter("serial", port, {{"fire", "FIRE\\n"}, {"reply", "OK"}, {"timeout", "10s"}}), kFile,
      *made.clock));
  return made;
}

RigUnderTest makeIio() {
  RigUnderTest made = onVirtualTime();
  const auto tree = std::make_shared<SysfsTree>();
  made.world = tree;
  tree->addIio(0, "i2c-1/1-0039", {{"name", "tsl2591\n"}, {"in_illuminance_input", "431.2\n"}});
  tree->addHwmon(1, "i2c-1/1-0048", {{"name", "lm75\n"}, {"temp1_input", "21500\n"}});
  made.rig.sensors.push_back(iio::makeSensor(sensor("lux0", "iio", Quantity::kIlluminance, {}),
                                             kFile, *made.clock, tree->root()));
  made.rig.sensors.push_back(iio::makeSensor(sensor("air0", "hwmon", Quantity::kTemperature, {}),
                                             kFile, *made.clock, tree->root()));
  return made;
}

class FreePin final : public gpio::OutputLine {
 public:
  Result<void> set(bool) override { return {}; }
};

RigUnderTest makeGpio() {
  RigUnderTest made = onVirtualTime();
  const gpio::RequestLine request = [](const gpio::LineName&) {
    return Result<std::unique_ptr<gpio::OutputLine>>(std::make_unique<FreePin>());
  };
  made.rig.lights.push_back(
      gpio::makeLight(lamp("gpio", "pins:1", {}), kFile, *made.clock, request));
  made.rig.triggers.push_back(
      gpio::makeTrigger(shutter("gpio", "pins:2", {{"half_line", "3"}, {"half", "200ms"}}), kFile,
                        *made.clock, request));
  return made;
}

struct UsbEnd {
  UsbTree tree;
  FakeBoards boards;
};

RigUnderTest makeUsb() {
  RigUnderTest made = onVirtualTime();
  const auto end = std::make_shared<UsbEnd>();
  made.world = end;
  end->tree.addHidraw(0);
  end->boards.at("hidraw0");
  const usb::UsbPlaces places{end->tree.root(), end->boards.opener()};
  made.rig.lights.push_back(
      usb::makeLight(lamp("usb", "HURTM", {{"relay", "1"}}), kFile, *made.clock, places));
  made.rig.triggers.push_back(
      usb::makeTrigger(shutter("usb", "HURTM", {{"relay", "2"}}), kFile, *made.clock, places));
  return made;
}

}  // namespace

std::vector<Backend> lineBackends() {
  return {{"ArtNet", [] { return makeDmx("artnet"); }},
          {"Sacn", [] { return makeDmx("sacn"); }},
          {"Serial", makeSerial},
          {"Iio", makeIio},
          {"Gpio", makeGpio},
          {"Usb", makeUsb}};
}

}  // namespace patina::testing
