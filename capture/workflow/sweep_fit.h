// SPDX-License-Identifier: GPL-3.0-or-later
// From one sweep's pictures to reflectance: fitted pixel by pixel, the mosaic's own samples where
// frames still hold them, then averaged over texels. Shadows, cracks and blades finer than a texel
// are told apart so.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "calibration/sensor/noise_model.h"
#include "capture/workflow/sweep_pictures.h"
#include "processing/brdf/multi_light_fit.h"

namespace patina::workflow {

// What one light state's pictures are multiplied by, and the light they are then of.
struct StateLight {
  brdf::SurfaceLight light;  // over the map
  double white_level = 1;    // of a frame, before
  bool even = false;      // frames are over what a flat white diffuser shows: its light is put back
  bool by_patch = false;  // shots are held to the patch, ArchiveFrames::holdToPatch
};

// What of `region` goes into texels of bin x bin pixels. Throws WorkflowError(kUsage) where none
// does.
RectPx wholeTexels(RectPx region, int bin);

// The region of a frame, as if a lamp of the model's own fall-off lit it.
Image<float> pixelsUnder(const StateLight& state, ImageView<const float> frame, RectPx region,
                         float mm_per_pixel);

// Of a pixel's sample, scaled as the states' pictures are on average; `averaged`: shots in each of
// them, of one exposure. Of brackets those as short as the shortest: none of them is clipped where
// light is brightest.
brdf::FitNoise noiseOfPixels(const calibration::NoiseModel& green,
                             const std::vector<StateLight>& states, int averaged = 1);

struct SweepFit {
  brdf::MultiLightOptions
      options;  // of pixels; `filters`, of the region's, where none is resampled
  std::vector<StateLight> states;
  RectPx region;  // whole texels
  int bin = 1;
  // Where every pixel's gloss is kept from step to step: a folder, or nothing.
  std::filesystem::path pixels;
};
// The colours of a mosaic's cell as a region of it begins with.
brdf::Filters filtersAt(const brdf::Filters& whole, int x, int y);

// `step`: number of the sweep, from 0. What `fit.pixels` has of the step before holds gloss, and
// what this one has replaces it. Throws as fitManyLights().
brdf::MultiLightFit fitSweep(const SweepFit& fit, const SweepPictures& sweep, int step,
                             Progress& progress);

}  // namespace patina::workflow
