// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/sky.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"

namespace patina::devices::twin {

namespace {

constexpr double kRoomDome = 0.15;
constexpr double kLatitudeDeg = 45, kDeclinationDeg = 10;
constexpr double kSunLeastSine = 0.08;  // lower, a wall is before it
constexpr double kSunAwayMm = 1e7, kSunRadiusDeg = 0.267;
constexpr double kCloudMinutes = 10;
constexpr double kSunLevel = 0.9, kDomeLevel = 0.4, kCloudDome = 0.1;

// 0 overcast, 1 clear.
double clearness(std::uint64_t seed, double hours) {
  const auto at = static_cast<float>(hours * 60 / kCloudMinutes);
  const float noise = gradientNoise(seed, at, 0.5f) + 0.5f * gradientNoise(seed, 3 * at, 7.5f);
  return smooth01(saturate(0.7f + 1.5f * noise));
}

}  // namespace

Sky skyAt(Surroundings surroundings, std::uint64_t seed, UtcTime utc) {
  Sky sky;
  if (surroundings == Surroundings::kDark) return sky;
  if (surroundings == Surroundings::kRoom) {
    sky.dome = kRoomDome;
    return sky;
  }
  constexpr std::int64_t kDayNs = 86'400'000'000'000;
  const std::int64_t ns = toNs(utc), of_day = (ns % kDayNs + kDayNs) % kDayNs;
  const double hours = static_cast<double>(of_day) / 3.6e12;
  const double turn = (hours - 12) / 12 * M_PI, lat = radians(kLatitudeDeg),
               dec = radians(kDeclinationDeg);
  // East is +x: the sun is there in the morning.
  const Point to_sun{
      -std::cos(dec) * std::sin(turn),
      std::cos(lat) * std::sin(dec) - std::sin(lat) * std::cos(dec) * std::cos(turn),
      std::sin(lat) * std::sin(dec) + std::cos(lat) * std::cos(dec) * std::cos(turn)};
  if (to_sun.z <= 0) return sky;
  const double clear = clearness(seed, static_cast<double>(ns / 1'000'000'000 % 31'536'000) / 3600);
  sky.dome = std::sqrt(to_sun.z) * (kDomeLevel - (kDomeLevel - kCloudDome) * 0.5 * clear);
  if (to_sun.z < kSunLeastSine) return sky;
  sky.sun = kSunLevel * to_sun.z * clear;
  sky.sun_place.position_mm = kSunAwayMm * to_sun;
  sky.sun_place.radius_mm = kSunAwayMm * std::tan(radians(kSunRadiusDeg));
  return sky;
}

}  // namespace patina::devices::twin
