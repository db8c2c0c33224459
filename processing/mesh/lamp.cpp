// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/lamp.h"

#include <cmath>
#include <numbers>

#include "processing/image/failure.h"

namespace patina::mesh {
namespace {

Lamp movedLamp(const Lamp& lamp, const std::array<double, 2>& by, double radius) {
  const std::array<double, 3> to = unitOf(lamp.at);
  const std::array<double, 3> side =
      std::abs(to[2]) < 0.9 ? unitOf({-to[1], to[0], 0}) : unitOf({to[2], 0, -to[0]});
  const std::array<double, 3> up{to[1] * side[2] - to[2] * side[1],
                                 to[2] * side[0] - to[0] * side[2],
                                 to[0] * side[1] - to[1] * side[0]};
  const double size = lamp.directional ? std::tan(radius * std::numbers::pi / 180) : radius;
  Lamp out = lamp;
  for (std::size_t c = 0; c < 3; ++c)
    out.at[c] = (lamp.directional ? to[c] : lamp.at[c]) + size * (by[0] * side[c] + by[1] * up[c]);
  return out;
}

}  // namespace

std::array<double, 3> unitOf(const std::array<double, 3>& direction) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length > 0) || !std::isfinite(length))
    throw ProcessingError(Exit::kUsage, "a light's direction has no length");
  return {direction[0] / length, direction[1] / length, direction[2] / length};
}

std::array<double, 2> onDisc(int i, int n) {
  const double r = n == 1 ? 0 : std::sqrt((i + 0.5) / n), angle = i * 2.399963229728653;
  return {r * std::cos(angle), r * std::sin(angle)};
}

std::vector<Lamp> spreadOf(const Lamp& lamp, const ShadowOptions& options) {
  const bool too_wide = lamp.directional && options.radius >= 90;
  if (options.rays < 1 || options.rays > 4096 || !(options.radius >= 0) || too_wide)
    throw ProcessingError(Exit::kUsage,
                          "a shadow takes 1 to 4096 rays and a radius of 0 or more, of a direction "
                          "below 90 degrees");
  std::vector<Lamp> lamps;
  for (int i = 0; i < options.rays; ++i)
    lamps.push_back(movedLamp(lamp, onDisc(i, options.rays), options.radius));
  return lamps;
}

}  // namespace patina::mesh
