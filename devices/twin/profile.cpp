// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/profile.h"

#include <cmath>
#include <string>

#include "devices/config_file.h"

namespace patina::devices::twin {

namespace {

double takePositive(ConfigTable& table, const std::string& key) {
  return table.takeNumber(key, 0, 1e9);
}
double takePercent(ConfigTable& table, const std::string& key) {
  return table.takeNumber(key, 0, 100) / 100;
}
Nanoseconds takeSeconds(ConfigTable& table, const std::string& key) {
  return fromSeconds(table.takeNumber(key, 0, 86'400));
}
int takeCount(ConfigTable& table, const std::string& key) {
  return static_cast<int>(table.takeInteger(key, 0, 65'536));
}

SensorProfile takeSensor(ConfigTable t) {
  SensorProfile p;
  p.full_well = takePositive(t, "full_well_e");
  p.read_noise = takePositive(t, "read_noise_e");
  p.bits = takeCount(t, "bits");
  p.black_level = takeCount(t, "black_level");
  p.dark_current = takePositive(t, "dark_current_e_per_s");
  p.dark_reference = Celsius{t.takeNumber("dark_reference_c", -40, 80)};
  p.dark_doubling_k = takePositive(t, "dark_doubling_k");
  p.prnu = takePercent(t, "prnu_percent");
  p.hot_pixel_every = takePositive(t, "hot_pixel_every");
  const auto hot = t.takeNumbers("hot_current_e_per_s", 2);
  p.hot_current_min = hot.at(0);
  p.hot_current_max = hot.at(1);
  p.grey_reflectance = t.takeNumber("grey_reflectance", 0, 1);
  p.grey_exposure = takeSeconds(t, "grey_exposure_s");
  p.grey_fill = t.takeNumber("grey_fill", 0, 1);
  p.readout_512 = takeSeconds(t, "readout_s_512");
  p.readout_min = takeSeconds(t, "readout_min_s");
  t.finish();
  return p;
}

LensProfile takeLens(ConfigTable t) {
  LensProfile p;
  p.k1 = t.takeNumber("k1", -1, 1);
  p.k2 = t.takeNumber("k2", -1, 1);
  p.focal_length = t.takeNumber("focal_length_widths", 0.1, 100);
  p.corner_falloff = takePercent(t, "corner_falloff_percent");
  t.finish();
  return p;
}

LampProfile takeLamp(ConfigTable t) {
  LampProfile p;
  p.shot_to_shot = takePercent(t, "shot_to_shot_percent");
  p.warm_up = takePercent(t, "warm_up_percent");
  p.warm_up_tau = takeSeconds(t, "warm_up_tau_s");
  p.ripple = takePercent(t, "ripple_percent");
  p.mains_hz = t.takeNumber("mains_hz", 10, 1000);
  p.illuminance_lux = takePositive(t, "illuminance_lux");
  t.finish();
  return p;
}

ExposureProfile takeExposure(ConfigTable t) {
  ExposureProfile p;
  p.mains_half_periods = takeCount(t, "mains_half_periods");
  p.min = takeSeconds(t, "min_s");
  p.max = takeSeconds(t, "max_s");
  t.finish();
  return p;
}

PatchProfile takePatch(ConfigTable t) {
  PatchProfile p;
  p.side_px = takeCount(t, "side_px");
  p.small_below_px = takeCount(t, "small_below_px");
  p.small_divisor = takeCount(t, "small_divisor");
  p.reflectance = t.takeNumber("reflectance", 0, 1);
  p.border_reflectance = t.takeNumber("border_reflectance", 0, 1);
  t.finish();
  return p;
}

RoomProfile takeRoom(ConfigTable t) {
  RoomProfile p;
  p.ambient = t.takeNumber("ambient", 0, 100);
  p.temperature_c = t.takeNumber("temperature_c", -40, 80);
  p.temperature_swing_c = takePositive(t, "temperature_swing_c");
  p.temperature_noise_c = takePositive(t, "temperature_noise_c");
  p.humidity = t.takeNumber("humidity_percent", 0, 100);
  p.humidity_swing = takePositive(t, "humidity_swing_percent");
  p.humidity_noise = takePositive(t, "humidity_noise_percent");
  p.lux_noise = takePercent(t, "lux_noise_percent");
  t.finish();
  return p;
}

ConfigTable takeSection(ConfigTable& file, const std::string& key) {
  auto table = file.takeTable(key);
  if (!table) file.reject(key, "the section is missing");
  return *table;
}

Profile parseProfile(std::string_view text) {
  ConfigTable file = ConfigFile::parse(std::string(text), "reference.toml");
  Profile p;
  p.sensor = takeSensor(takeSection(file, "sensor"));
  p.lens = takeLens(takeSection(file, "lens"));
  p.lamp = takeLamp(takeSection(file, "lamp"));
  p.exposure = takeExposure(takeSection(file, "exposure"));
  p.patch = takePatch(takeSection(file, "patch"));
  p.room = takeRoom(takeSection(file, "room"));
  file.finish();
  return p;
}

}  // namespace

double SensorProfile::darkFactor(Celsius temperature) const {
  return std::exp2((temperature.value - dark_reference.value) / dark_doubling_k);
}

const Profile& referenceProfile() {
  static const Profile profile = parseProfile(referenceProfileText());
  return profile;
}

}  // namespace patina::devices::twin
