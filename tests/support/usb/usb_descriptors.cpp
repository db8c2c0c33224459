// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/usb_descriptors.h"

#include <cstdio>

#include "devices/twin/dslr/ptp_data.h"
#include "tests/support/usb/usb_ptp.h"

namespace patina::testing {
namespace {

using devices::twin::dslr::PtpReader;
using devices::twin::dslr::PtpWriter;

constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kText = 3, kInterface = 4, kEndpoint = 5;
constexpr std::uint8_t kManufacturerText = 1, kNameText = 2, kSerialText = 3;
constexpr std::uint16_t kConfigurationBytes = 9 + 9 + 3 * 7;

void bytes(PtpWriter& to, std::initializer_list<int> values) {
  for (const int v : values) to.u8(static_cast<std::uint8_t>(v));
}

void endpoint(PtpWriter& to, int address, int type, int packet_bytes, int interval) {
  bytes(to, {7, kEndpoint, address, type, packet_bytes & 255, packet_bytes >> 8, interval});
}

std::string hex(const Bytes& from) {
  std::string text;
  for (const std::byte b : from) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02X", std::to_integer<unsigned>(b));
    text += digits;
  }
  return text;
}

std::string digits(const char* format, int v) {
  char text[16];
  std::snprintf(text, sizeof text, format, v);
  return text;
}

}  // namespace

Bytes usbDescriptors(const UsbIdentity& who) {
  PtpWriter out;
  bytes(out, {18, kDevice, 0x00, 0x02, 0, 0, 0, 64});  // USB 2.0, class by interface
  out.u16(who.vendor);
  out.u16(who.product);
  out.u16(0x0100);
  bytes(out, {kManufacturerText, kNameText, kSerialText, 1});
  bytes(out, {9, kConfiguration});
  out.u16(kConfigurationBytes);
  bytes(out, {1, 1, 0, 0xC0, 1});                       // powered by itself
  bytes(out, {9, kInterface, 0, 0, 3, 0x06, 1, 1, 0});  // still image, PIMA 15740
  endpoint(out, kBulkIn, 2, 512, 0);
  endpoint(out, kBulkOut, 2, 512, 0);
  endpoint(out, kInterruptIn, 3, 64, 6);
  return out.take();
}

std::optional<Bytes> textDescriptor(const UsbIdentity& who, std::span<const std::byte> setup) {
  PtpReader from(setup);
  const int type = from.u8(), request = from.u8(), index = from.u8(), kind = from.u8();
  if (from.bad() || type != 0x80 || request != 6 || kind != kText) return std::nullopt;
  PtpWriter out;
  if (index == 0) {
    bytes(out, {4, kText, 0x09, 0x04});  // English
    return out.take();
  }
  const std::string text = index == kManufacturerText ? who.manufacturer
                           : index == kNameText       ? who.name
                                                      : who.serial;
  bytes(out, {static_cast<int>(2 + 2 * text.size()), kText});
  for (const char c : text) out.u16(static_cast<unsigned char>(c));
  return out.take();
}

std::string usbDevice(const UsbIdentity& who, const std::string& name, int number) {
  const std::string descriptors = hex(usbDescriptors(who));
  const std::string node = "bus/usb/001/" + digits("%03d", number);
  std::string text = "P: /devices/pci0000:00/0000:00:14.0/usb1/" + name + "\n";
  text += "N: " + node + "=" + descriptors + "\n";
  const auto property = [&](const char* key, const std::string& value) {
    text += std::string("E: ") + key + "=" + value + "\n";
  };
  const auto attribute = [&](const char* key, const std::string& value) {
    text += std::string("A: ") + key + "=" + value + "\\n\n";
  };
  property("DEVNAME", "/dev/" + node);
  property("DEVTYPE", "usb_device");
  property("SUBSYSTEM", "usb");
  property("BUSNUM", "001");
  property("DEVNUM", digits("%03d", number));
  property("MAJOR", "189");
  property("MINOR", std::to_string(number - 1));
  property("ID_GPHOTO2", "1");
  property("ID_SERIAL_SHORT", who.serial);
  attribute("dev", "189:" + std::to_string(number - 1));
  attribute("busnum", "1");
  attribute("devnum", std::to_string(number));
  attribute("devpath", name.substr(name.find('-') + 1));
  attribute("speed", "480");
  attribute("bConfigurationValue", "1");
  attribute("bNumConfigurations", "1");
  attribute("bDeviceClass", "00");
  attribute("idVendor", digits("%04x", who.vendor));
  attribute("idProduct", digits("%04x", who.product));
  attribute("manufacturer", who.manufacturer);
  attribute("product", who.name);
  attribute("serial", who.serial);
  attribute("authorized", "1");
  text += "H: descriptors=" + descriptors + "\n";
  return text;
}

}  // namespace patina::testing
