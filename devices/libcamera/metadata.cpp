// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/metadata.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace patina::devices::libcamera {
namespace {

constexpr double kTolerance = 0.01;
constexpr double kFocusTolerance = 0.05;  // dioptres: lenses move in steps

bool near(double asked, double got, double least) {
  return std::abs(got - asked) <= std::max(least, kTolerance * std::abs(asked));  // NaN is not
}

struct Value {
  const char* name;
  const char* unit;
  std::optional<double> asked, got;
  bool must_be_said = false;
  double least_tolerance = 0;
};

std::optional<Verdict> problemOf(const Value& value) {
  if (!value.asked) return std::nullopt;
  if (!value.got) {
    if (!value.must_be_said) return std::nullopt;
    return Verdict{Verdict::kUnsaid, std::string(value.name) + ": the camera does not say"};
  }
  if (near(*value.asked, *value.got, value.least_tolerance)) return std::nullopt;
  char text[120];
  std::snprintf(text, sizeof text, "%s: asked %.6g%s, got %.6g%s", value.name, *value.asked,
                value.unit, *value.got, value.unit);
  return Verdict{Verdict::kDiffers, text};
}

std::optional<double> seconds(const std::optional<Nanoseconds>& time) {
  return time ? std::optional(toSeconds(*time)) : std::nullopt;
}

std::optional<double> part(const std::optional<std::array<double, 2>>& pair, std::size_t i) {
  return pair ? std::optional((*pair)[i]) : std::nullopt;
}

}  // namespace

Verdict judge(const Controls& asked, const Metadata& frame) {
  const Controls& got = frame.applied;
  const Value values[] = {
      {"exposure", " s", seconds(asked.exposure), seconds(got.exposure), true},
      {"analogue gain", "", asked.analogue_gain, got.analogue_gain, true},
      {"digital gain", "", 1.0, frame.digital_gain},
      {"red gain", "", part(asked.colour_gains, 0), part(got.colour_gains, 0)},
      {"blue gain", "", part(asked.colour_gains, 1), part(got.colour_gains, 1)},
      {"focus", " dioptres", asked.focus_dioptres, got.focus_dioptres, false, kFocusTolerance}};
  for (const Value& value : values)
    if (auto problem = problemOf(value)) return *problem;
  return {};
}

}  // namespace patina::devices::libcamera
