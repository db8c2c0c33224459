// SPDX-License-Identifier: GPL-3.0-or-later
// From a sweep's pixels to the texels of a fit: what each shows, in which light, with what noise.
#pragma once

#include <vector>

#include "calibration/sensor/noise_model.h"
#include "processing/brdf/multi_light_fit.h"

namespace patina::workflow {

// What one light state's pictures are multiplied by, and the light they are then of.
struct StateLight {
  brdf::SurfaceLight light;  // over the map
  double white_level = 1;    // of a frame, before
  bool even = false;  // frames are over what a flat white diffuser shows: its light is put back
};

// What of `region` goes into texels of bin x bin pixels. Throws WorkflowError(kUsage) where none
// does.
RectPx wholeTexels(RectPx region, int bin);

// The region of a frame, as if a lamp of the model's own fall-off lit it.
Image<float> texelsUnder(const StateLight& state, ImageView<const float> frame, RectPx region,
                         int bin, float mm_per_texel);

// Of texels of bin x bin pixels of a mosaic, whose samples of one colour are a quarter; scaled as
// the states' pictures are on average.
brdf::FitNoise noiseOfTexels(const calibration::NoiseModel& green,
                             const std::vector<StateLight>& states, int bin);

}  // namespace patina::workflow
