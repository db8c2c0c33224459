// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/guest/relay_gadget.h"

namespace patina::testing {
namespace {

Bytes bytesOf(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

// One feature report of eight bytes, of the maker's own meaning.
const Bytes& reportDescriptor() {
  static const Bytes kReport =
      bytesOf({0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x26, 0xFF,
               0x00, 0x75, 0x08, 0x95, 0x08, 0x09, 0x00, 0xB2, 0x02, 0x01, 0xC0});
  return kReport;
}

Bytes interfaceOfBoard() {
  const int report_bytes = static_cast<int>(reportDescriptor().size());
  return bytesOf({9, 4,    0,    0,    1, 3, 0,    0,
                  0,  // HID
                  9, 0x21, 0x01, 0x01, 0, 1, 0x22, report_bytes,
                  0, 7,    5,    0x81, 3, 8, 0,    10});  // an interrupt pipe that stays silent
}

constexpr unsigned kFromInterface = 0x81, kGetDescriptor = 6, kReportDescriptor = 0x22;
constexpr unsigned kClassIn = 0xA1, kGetReport = 1;
constexpr unsigned kClassOut = 0x21, kSetReport = 9, kSetIdle = 10;
constexpr unsigned kClose = 0xFF, kOpen = 0xFD;

}  // namespace

RelayGadget::RelayGadget(const std::string& serial, devices::Clock& clock)
    : serial_(serial),
      usb_(
          {"relays", 0x16c0, 0x05df, "www.dcttech.com", "USBRelay4", serial}, interfaceOfBoard(), 1,
          [this](auto setup, auto data) { return onSetup(setup, data); }, clock) {}

std::optional<Bytes> RelayGadget::onSetup(std::span<const std::byte, 8> setup,
                                          std::span<const std::byte> data) {
  const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(setup[i]); };
  if (at(0) == kFromInterface && at(1) == kGetDescriptor && at(3) == kReportDescriptor)
    return reportDescriptor();
  if (at(0) == kClassIn && at(1) == kGetReport) {
    Bytes report(8);
    for (std::size_t i = 0; i < serial_.size(); ++i) report[i] = static_cast<std::byte>(serial_[i]);
    report[7] = static_cast<std::byte>(relays_.load());
    return report;
  }
  if (at(0) == kClassOut && at(1) == kSetIdle) return Bytes{};
  if (at(0) != kClassOut || at(1) != kSetReport || data.size() < 2) return std::nullopt;
  const unsigned what = std::to_integer<unsigned>(data[0]);
  const unsigned bit = 1u << (std::to_integer<unsigned>(data[1]) - 1);
  if (stuck_) return Bytes{};
  if (what == kClose) relays_ |= bit;
  if (what == kOpen) relays_ &= ~bit;
  return Bytes{};
}

}  // namespace patina::testing
