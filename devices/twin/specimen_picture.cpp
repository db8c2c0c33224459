// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen_picture.h"

#include <cmath>
#include <numeric>

#include "devices/twin/relief_shadow.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/shading.h"

namespace patina::devices::twin {

namespace {

constexpr double kLampRadiusMm = 20;
constexpr float kRoom = 0.10f;  // of the lamp's light comes back from the walls
constexpr double kShareBelow = 0.99;
constexpr double kStepsPerStop = 256;
constexpr double kStops = 24, kDarkestStop = -14;  // what the histogram spans, around white

// One row of truth, channels apart.
void takeRow(const SurfaceMaps& maps, int y, SurfaceRow& row) {
  const auto apart = [&](const Image<float>& from, SurfaceRow::Channel first) {
    const float* in = from.view().row(y);
    for (int c = 0; c < from.channels(); ++c) {
      float* out = row[static_cast<SurfaceRow::Channel>(first + c)];
      for (int x = 0; x < row.width(); ++x) out[x] = in[x * from.channels() + c];
    }
  };
  apart(maps.diffuse, SurfaceRow::kDiffuseR);
  apart(maps.specular, SurfaceRow::kSpecularR);
  apart(maps.normal, SurfaceRow::kNormalX);
  apart(maps.roughness, SurfaceRow::kRoughness);
  apart(maps.height, SurfaceRow::kHeight);
  apart(maps.degree, SurfaceRow::kDegree);
}

Image<float> shade(const Specimen& specimen, double time, SizePx size, const Point& lamp_mm) {
  const SurfaceMaps maps = specimen.surfaceAt(time, size);
  const CameraView view(SampleGrid::regular(size, specimen.info().width_mm));
  LampPlace place;
  place.position_mm = lamp_mm;
  place.radius_mm = kLampRadiusMm;
  const LampField lamp(view, place, false);
  ReliefShadow relief(view.ground());
  relief.setHeights(maps.height.texels());
  const std::vector<float> visibility = relief.visibility(place);
  Image<float> picture(size.width, size.height, 3);
  forRowBlocks(size, [&](int y0, int y1) {
    SurfaceRow surface(size.width);
    std::vector<float> scratch, light(static_cast<std::size_t>(size.width));
    for (int y = y0; y < y1; ++y) {
      takeRow(maps, y, surface);
      const ShadedRow row{surface,
                          lamp.row(y, scratch),
                          {},
                          specimen.measured(),
                          &visibility[view.ground().index(0, y)]};
      float* out = picture.view().row(y);
      for (int c = 0; c < 3; ++c) {
        shadeChannelRow(row, c, light.data());
        addSkyChannelRow(surface, c, kRoom, light.data());
        for (int x = 0; x < size.width; ++x) out[3 * x + c] = light[x];
      }
    }
  });
  return picture;
}

}  // namespace

// Twice as fine, and every four texels averaged: edges of relief and shadow are smooth.
Image<float> shadedPicture(const Specimen& specimen, double time, SizePx size,
                           const std::array<double, 3>& lamp_mm) {
  if (!(lamp_mm[2] > 0))
    throw ProcessingError(Exit::kUsage,
                          "the lamp must be above the specimen: its z is in front "
                          "of it, in mm, more than 0");
  const Image<float> fine = shade(specimen, time, {2 * size.width, 2 * size.height}, lamp_mm);
  Image<float> picture(size.width, size.height, 3);
  forRowBlocks(size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      const float *upper = fine.view().row(2 * y), *lower = fine.view().row(2 * y + 1);
      float* out = picture.view().row(y);
      for (int x = 0; x < size.width; ++x)
        for (int c = 0; c < 3; ++c)
          out[3 * x + c] =
              (upper[6 * x + c] + upper[6 * x + 3 + c] + lower[6 * x + c] + lower[6 * x + 3 + c]) /
              4;
    }
  });
  return picture;
}

FilmExposure::FilmExposure() : pixels_(static_cast<std::size_t>(kStops * kStepsPerStop)) {}

void FilmExposure::add(ImageView<const float> picture) {
  const double last = static_cast<double>(pixels_.size()) - 1;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto texel = picture.texel(x, y);
      const double brightest = *std::max_element(texel.begin(), texel.end());
      const double step = brightest > 0 ? (std::log2(brightest) - kDarkestStop) * kStepsPerStop : 0;
      ++pixels_[static_cast<std::size_t>(std::clamp(step, 0.0, last))];
    }
}

double FilmExposure::gain() const {
  const auto total = std::accumulate(pixels_.begin(), pixels_.end(), std::int64_t{0});
  std::int64_t below = 0;
  std::size_t step = 0;
  while (step + 1 < pixels_.size() &&
         static_cast<double>(below += pixels_[step]) < kShareBelow * static_cast<double>(total))
    ++step;
  if (step == 0) return 1;
  return std::exp2(-(static_cast<double>(step) + 0.5) / kStepsPerStop - kDarkestStop);
}

}  // namespace patina::devices::twin
