// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's device properties: types, choices, values. Whatever is set is one of the choices.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/twin/dslr/ptp_codes.h"
#include "devices/twin/dslr/ptp_data.h"

namespace patina::devices::twin::dslr {

enum class DataType : std::uint16_t { kU8 = 0x0002, kU16 = 0x0004, kU32 = 0x0006, kText = 0xFFFF };
enum class Form : std::uint8_t { kNone = 0, kRange = 1, kChoices = 2 };

struct Setting {
  Property property;
  DataType type;
  Form form = Form::kChoices;
  bool writable = true;
  std::vector<std::int64_t> choices;  // of kRange: least, most, step
  std::int64_t factory = 0, value = 0;
  std::string text;  // the value of a kText
};

// Thread-bound: its camera's lock guards it. Exposure times count in 0.1 ms, as PTP has it; the
// camera exposes for exactly what it says.
class CameraSettings {
 public:
  explicit CameraSettings(SizePx size);

  std::vector<std::uint16_t> codes() const;
  Setting* find(Property property);
  std::int64_t value(Property property) const;
  void set(Property property, std::int64_t value);  // by the camera itself; no questions asked
  void setText(Property property, const std::string& text);

  std::optional<Bytes> describe(Property property) const;  // DevicePropDesc
  std::optional<Bytes> read(Property property) const;
  Answer write(Property property, std::span<const std::byte> data);
  void reset(Property property);  // to its factory value

  // A dial that nobody turned: the exposure time moves to a neighbouring choice.
  void turnTheDial();
  Exposure exposure() const;

 private:
  const Setting& at(Property property) const;
  std::vector<Setting> settings_;
};

}  // namespace patina::devices::twin::dslr
