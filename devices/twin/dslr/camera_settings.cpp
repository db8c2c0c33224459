// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/camera_settings.h"

#include <algorithm>

#include "processing/image/failure.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr std::int64_t kNsPerTick = 100'000;  // of an exposure time
const std::vector<std::int64_t> kTimes = {
    1,     2,     5,     10,    12,     16,     20,     25,     31,     40,    50,    63,    80,
    100,   125,   167,   200,   250,    333,    400,    500,    667,    769,   1000,  1250,  1667,
    2000,  2500,  3333,  4000,  5000,   6000,   8000,   10000,  13000,  16000, 20000, 25000, 32000,
    40000, 50000, 60000, 80000, 100000, 130000, 150000, 200000, 250000, 300000};
const std::vector<std::int64_t> kHundredthsOfF = {
    140, 160, 180, 200, 220,  250,  280,  320,  350,  400,  450,  500, 560,
    630, 710, 800, 900, 1000, 1100, 1300, 1400, 1600, 1800, 2000, 2200};
const std::vector<std::int64_t> kIsos = {100,  125,  160,  200,  250,  320,     400,
                                         500,  640,  800,  1000, 1250, 1600,    2000,
                                         2500, 3200, 4000, 5000, 6400, kAutoIso};

Setting choice(Property property, DataType type, std::vector<std::int64_t> choices,
               std::int64_t factory) {
  return {property, type, Form::kChoices, true, std::move(choices), factory, factory, {}};
}

int bytesOf(DataType type) { return type == DataType::kU8 ? 1 : type == DataType::kU16 ? 2 : 4; }

void put(PtpWriter& to, const Setting& setting, std::int64_t value) {
  if (setting.type == DataType::kText) return to.text(setting.text);
  to.number(static_cast<std::uint64_t>(value), bytesOf(setting.type));
}

}  // namespace

CameraSettings::CameraSettings(SizePx size) {
  settings_.push_back(
      {Property::kBatteryLevel, DataType::kU8, Form::kRange, false, {0, 100, 1}, 100, 100, {}});
  settings_.push_back({Property::kImageSize,
                       DataType::kText,
                       Form::kChoices,
                       false,
                       {0},
                       0,
                       0,
                       std::to_string(size.width) + "x" + std::to_string(size.height)});
  settings_.push_back(
      choice(Property::kCompression, DataType::kU8, {kJpegOnly, kRawOnly, kRawAndJpeg}, kJpegOnly));
  settings_.push_back(choice(Property::kWhiteBalance, DataType::kU16,
                             {kManualWhite, kAutomaticWhite, 4, 5, 6, 7}, 4));
  settings_.push_back(choice(Property::kFNumber, DataType::kU16, kHundredthsOfF, 800));
  settings_.push_back(
      choice(Property::kFocusMode, DataType::kU16, {kManualFocus, kAutofocus}, kManualFocus));
  settings_.push_back(choice(Property::kExposureTime, DataType::kU32, kTimes, 100));
  settings_.push_back(choice(Property::kExposureProgram, DataType::kU16,
                             {kManual, kProgram, kAperture, kShutter}, kManual));
  settings_.push_back(choice(Property::kExposureIndex, DataType::kU16, kIsos, 100));
  settings_.push_back(
      {Property::kDateTime, DataType::kText, Form::kNone, true, {}, 0, 0, "20240101T000000.0"});
  settings_.push_back(choice(Property::kCaptureMode, DataType::kU16, {1}, 1));
  settings_.push_back(choice(Property::kSaveTo, DataType::kU8, {kToCard, kToMemory}, kToCard));
  settings_.push_back({Property::kShutterCount, DataType::kU32, Form::kNone, false, {}, 0, 0, {}});
}

std::vector<std::uint16_t> CameraSettings::codes() const {
  std::vector<std::uint16_t> codes;
  for (const Setting& setting : settings_)
    codes.push_back(static_cast<std::uint16_t>(setting.property));
  return codes;
}

Setting* CameraSettings::find(Property property) {
  const auto found = std::ranges::find(settings_, property, &Setting::property);
  return found == settings_.end() ? nullptr : &*found;
}

const Setting& CameraSettings::at(Property property) const {
  const auto found = std::ranges::find(settings_, property, &Setting::property);
  PATINA_CHECK(found != settings_.end());
  return *found;
}

std::int64_t CameraSettings::value(Property property) const { return at(property).value; }

void CameraSettings::set(Property property, std::int64_t value) { find(property)->value = value; }

void CameraSettings::setText(Property property, const std::string& text) {
  find(property)->text = text;
}

std::optional<Bytes> CameraSettings::describe(Property property) const {
  const auto found = std::ranges::find(settings_, property, &Setting::property);
  if (found == settings_.end()) return std::nullopt;
  const Setting& setting = *found;
  PtpWriter out;
  out.u16(static_cast<std::uint16_t>(setting.property));
  out.u16(static_cast<std::uint16_t>(setting.type));
  out.u8(setting.writable ? 1 : 0);
  put(out, setting, setting.factory);
  put(out, setting, setting.value);
  out.u8(static_cast<std::uint8_t>(setting.form));
  if (setting.form == Form::kChoices) out.u16(static_cast<std::uint16_t>(setting.choices.size()));
  if (setting.form != Form::kNone)
    for (const std::int64_t one : setting.choices) put(out, setting, one);
  return out.take();
}

std::optional<Bytes> CameraSettings::read(Property property) const {
  const auto found = std::ranges::find(settings_, property, &Setting::property);
  if (found == settings_.end()) return std::nullopt;
  PtpWriter out;
  put(out, *found, found->value);
  return out.take();
}

Answer CameraSettings::write(Property property, std::span<const std::byte> data) {
  Setting* const setting = find(property);
  if (setting == nullptr) return Answer::kDevicePropNotSupported;
  if (!setting->writable) return Answer::kAccessDenied;
  PtpReader from(data);
  if (setting->type == DataType::kText) {
    const std::string text = from.text();
    if (from.bad() || from.left() > 0) return Answer::kInvalidDevicePropFormat;
    setting->text = text;
    return Answer::kOk;
  }
  const auto value = static_cast<std::int64_t>(from.number(bytesOf(setting->type)));
  if (from.bad() || from.left() > 0) return Answer::kInvalidDevicePropFormat;
  if (std::ranges::find(setting->choices, value) == setting->choices.end())
    return Answer::kInvalidDevicePropValue;
  setting->value = value;
  return Answer::kOk;
}

void CameraSettings::reset(Property property) {
  Setting* const setting = find(property);
  setting->value = setting->factory;
}

void CameraSettings::turnTheDial() {
  Setting& time = *find(Property::kExposureTime);
  const auto now = std::ranges::find(time.choices, time.value);
  time.value = now + 1 == time.choices.end() ? *(now - 1) : *(now + 1);
}

Exposure CameraSettings::exposure() const {
  const std::int64_t iso = value(Property::kExposureIndex);
  Exposure exposure;
  exposure.time = Nanoseconds(value(Property::kExposureTime) * kNsPerTick);
  exposure.iso = Iso{iso == kAutoIso ? 400.0 : static_cast<double>(iso)};
  exposure.f_number = FNumber{static_cast<double>(value(Property::kFNumber)) / 100};
  return exposure;
}

}  // namespace patina::devices::twin::dslr
