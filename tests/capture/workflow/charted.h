// SPDX-License-Identifier: GPL-3.0-or-later
// ColorCheckers in front of the twin's camera, and drawn ones in files.
#pragma once

#include <string>
#include <vector>

#include "calibration/colour/delta_e.h"
#include "capture/workflow/colour_calibration.h"
#include "devices/twin/scene_target.h"
#include "tests/calibration/colour/drawn_chart.h"
#include "tests/devices/twin/bench_rig.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {

struct ChartScene {
  std::array<double, 3> position_mm{0, 0, 0.5}, rotation_deg{};
  double width_mm = 70;
  std::array<double, 3> key_mm{-260, 220, 600}, fill_mm{300, 100, 400};
  std::vector<double> levels{1, 0};  // of key and fill
  devices::FaultPlan faults{};
};

inline std::string listed(const std::array<double, 3>& v) {
  return "[" + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " + std::to_string(v[2]) +
         "]";
}

inline devices::RigSpec rigOf(const ChartScene& scene) {
  return devices::parseRig(
      "name = 'chart'\n"
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "settings = { position_mm = '0,0,420', focal_widths = 4.2 }\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = " +
          listed(scene.key_mm) +
          "\n[[light]]\nid = 'fill'\nbackend = 'twin'\nposition_mm = " + listed(scene.fill_mm) +
          "\n[twin]\nspecimen = 'grey_card'\nsize = '640x480'\n"
          "[[twin.target]]\nkind = 'colorchecker'\nposition_mm = " +
          listed(scene.position_mm) + "\nrotation_deg = " + listed(scene.rotation_deg) +
          "\nwidth_mm = " + std::to_string(scene.width_mm) + "\n",
      "rig.toml");
}

// The raw file of an hour after the lamps were lit.
inline std::filesystem::path shootChart(const ChartScene& scene, const TempFolder& folder) {
  devices::twin::TwinOptions options;
  options.duration = std::chrono::hours(100);
  options.faults = scene.faults;
  devices::twin::Bench bench(rigOf(scene), options);
  for (std::size_t i = 0; i < scene.levels.size(); ++i) bench.light(i, scene.levels[i]);
  bench.advance(std::chrono::hours(1));
  const std::filesystem::path file = folder / "chart.dng";
  writeFileAtomically(file, bench.shoot().at(0).bytes);
  return file;
}

// "L a b" of the twin's own chart, from what its fields reflect.
inline std::filesystem::path writeTwinColours(const TempFolder& folder) {
  devices::TargetSpec chart;
  chart.kind = devices::TargetSpec::kColorChecker;
  std::string text;
  for (int i = 0; i < calibration::kChartFields; ++i) {
    const auto rgb = devices::twin::targetReflectance(chart, (i % 6 + 0.5) / 6, (i / 6 + 0.5) / 4);
    const auto xyz = calibration::mapped(calibration::xyzFromLinearSrgb(), rgb);
    const calibration::Lab lab = calibration::labOf({xyz[0], xyz[1], xyz[2]});
    text +=
        std::to_string(lab.l) + " " + std::to_string(lab.a) + " " + std::to_string(lab.b) + "\n";
  }
  const std::filesystem::path file = folder / "twin_chart.txt";
  writeFileAtomically(file, text);
  return file;
}

// Linear, as EXR: whatever the camera of `drawn` sees.
inline std::filesystem::path plantChart(const calibration::Drawn& drawn, const TempFolder& folder) {
  const std::filesystem::path file = folder / "chart.exr";
  writeExr(file, calibration::drawChart(drawn).view());
  return file;
}

}  // namespace patina::testing
