// SPDX-License-Identifier: GPL-3.0-or-later
// The twin under lamps whose places are known: what directions and fields are held against.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/twin/picture_maker.h"

namespace patina::calibration {

namespace twin = devices::twin;

struct LampRing {
  std::string specimen = "steel_rusting";
  std::string size = "512x512";
  std::vector<std::array<double, 3>> lamps_mm;
  std::vector<devices::TargetSpec> targets;
  twin::CameraPose pose;
  std::string faults{};
};

// `count` lamps at `distance_mm` from the middle, from 25 to 75 degrees above the specimen.
inline std::vector<std::array<double, 3>> lampsAround(int count, double distance_mm) {
  std::vector<std::array<double, 3>> lamps;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.39996 * i, height = (25 + 50 * ((i + 0.5) / count)) * M_PI / 180;
    lamps.push_back({distance_mm * std::cos(height) * std::cos(azimuth),
                     distance_mm * std::cos(height) * std::sin(azimuth),
                     distance_mm * std::sin(height)});
  }
  return lamps;
}

class RingTwin {
 public:
  explicit RingTwin(const LampRing& ring)
      : spec_(specOf(ring)),
        clock_(UtcTime{}),
        world_(spec_, optionsOf(), clock_),
        maker_(world_, spec_.cameras.at(0), ring.pose, 7) {}

  std::size_t lamps() const { return spec_.lights.size(); }
  twin::PictureMaker& maker() { return maker_; }
  // Levels of each lamp; nothing warms up, flickers or ages.
  twin::ShotLight shotAt(std::vector<double> levels, Nanoseconds exposure, int shot = 0) const {
    twin::ShotLight light;
    light.exposure.time = exposure;
    light.exposure.f_number = FNumber{8};
    light.exposure.iso = Iso{100};
    light.temperature = Celsius{20};
    light.noise_key = 1000 + static_cast<std::uint64_t>(shot);
    light.levels = std::move(levels);
    return light;
  }
  // As decoded from its file: [h][w][3] linear, share of full scale.
  Image<float> picture(const std::vector<double>& levels, Nanoseconds exposure, int shot = 0) {
    return demosaic(maker_.expose(shotAt(levels, exposure, shot)));
  }
  Image<float> pictureOf(std::size_t lamp, Nanoseconds exposure) {
    std::vector<double> levels(lamps(), 0.0);
    levels[lamp] = 1;
    return picture(levels, exposure, static_cast<int>(lamp));
  }

 private:
  static twin::TwinOptions optionsOf() {
    twin::TwinOptions options;
    options.duration = std::chrono::hours(24);
    return options;
  }
  static devices::RigSpec specOf(const LampRing& ring) {
    std::string toml = "name = 'ring'\n[[camera]]\nid = 'cam0'\nbackend = 'twin'\n";
    for (std::size_t i = 0; i < ring.lamps_mm.size(); ++i) {
      const auto& [x, y, z] = ring.lamps_mm[i];
      toml += "[[light]]\nid = 'l" + std::to_string(i) + "'\nbackend = 'twin'\nposition_mm = [" +
              std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + "]\n";
    }
    toml += "[twin]\nspecimen = '" + ring.specimen + "'\nsize = '" + ring.size + "'\n";
    devices::RigSpec spec = devices::parseRig(toml, "rig.toml");
    spec.twin->targets = ring.targets;
    return spec;
  }

  devices::RigSpec spec_;
  devices::VirtualClock clock_;
  twin::World world_;
  twin::PictureMaker maker_;
};

inline devices::TargetSpec mirrorSphere(std::array<double, 3> middle_mm, double width_mm) {
  devices::TargetSpec sphere;
  sphere.kind = devices::TargetSpec::kMirrorSphere;
  sphere.position_mm = middle_mm;
  sphere.width_mm = width_mm;
  sphere.reflectance = 0.9;
  return sphere;
}
inline devices::TargetSpec greyCard(std::array<double, 3> middle_mm, double width_mm,
                                    double reflectance) {
  devices::TargetSpec card;
  card.kind = devices::TargetSpec::kGreyCard;
  card.position_mm = middle_mm;
  card.width_mm = width_mm;
  card.reflectance = reflectance;
  return card;
}

}  // namespace patina::calibration
