// SPDX-License-Identifier: GPL-3.0-or-later
// Between the passes of the fit: what is known of each texel, and what neighbours say. Only the fit
// includes this.
#pragma once

#include <span>
#include <vector>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf {

constexpr float kWideLogR = -1.2f, kWideLogRWeight = 0.5f;  // of a texel nobody knows: e^-1.2
// Specular reflectance expected of what is no metal: water's is 0.02, glass's 0.04.
constexpr float kDielectric = 0.025f;
// 2 ln of how much less likely what is no dielectric has a given reflectance than a dielectric has
// its own: as often met, spread seven times as wide.
constexpr float kAnyPrice = 4;

// [h][w] each, of one kind of number.
struct FitState {
  FitState(SizePx size, int channels);
  SizePx size;
  Image<float> normal;             // [h][w][3]
  Image<float> diffuse, specular;  // [h][w][channels of the pictures]
  Image<float> specular_weight;    // 1 / variance, by the texel's own lights and the prior of ln r
  Image<float> grey_diffuse, grey_specular, log_r;
  Image<float> confidence, residual;
  Image<std::uint8_t> told, shadowed;  // five levels count; most lamps do not reach it
  Image<float> spread2;                // of the residuals, in units of the noise, at least 1
  Image<float> misfit;                 // the same, whatever it is
  Image<float> lamps;                  // share of the noise's variance that is the lamps'
  Image<float> own_specular;           // [h][w][channels] as the own lights alone have it
  Image<float>
      look;  // [h][w][channels], of a mosaic [3]: levels over irradiance, known whatever the gloss
  // [h][w][kCurve], by roughness, in units of the texel's spread: with the specular reflectance ks
  // a texel costs curve - 2 moment ks + information ks^2
  Image<float> curve, curve_moment, curve_information;
};

// What texels are held to: means and certainties (1 / variance, 0: nobody knows).
struct PriorMaps {
  PriorMaps(SizePx size, int channels);
  Image<float> log_r, log_r_weight;
  Image<float> expected_specular, expected_weight;  // of the pool's roughness; 0: may be a metal
  Image<float> specular, specular_weight;           // [h][w][channels], [h][w][1]
};

// The specular reflectances that like-looking texels' own lights tell, and `before`, are averaged,
// once the roughness is settled (roughness_pool.h). Strips of columns in parallel.
void poolSpecular(const FitState& state, const std::vector<FitBefore>& before,
                  const MultiLightOptions& options, PriorMaps& prior, Progress& progress);

}  // namespace patina::brdf
