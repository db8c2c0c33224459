// SPDX-License-Identifier: GPL-3.0-or-later
// Between the passes of the fit: what is known of each texel, and what neighbours say. Only the fit
// includes this.
#pragma once

#include <span>
#include <vector>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf {

constexpr float kWideLogR = -1.2f, kWideLogRWeight = 1.5f;  // of a texel nobody knows: e^-1.2
constexpr float kDielectric = 0.04f;  // specular reflectance at an index of refraction of 1.5

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
  // [h][w][kCurve], by roughness: cost in units of the texel's spread, as ofLikeTexels() leaves it,
  // its slope by ln r, and the specular reflectance
  Image<float> curve, curve_slope, curve_specular;
};

// What texels are held to: means and certainties (1 / variance, 0: nobody knows).
struct PriorMaps {
  PriorMaps(SizePx size, int channels);
  Image<float> log_r, log_r_weight;
  Image<float> dielectric_weight;          // of kDielectric; 0: may be a metal
  Image<float> specular, specular_weight;  // [h][w][channels], [h][w][1]
};

// From a texel's costs of its own roughness, [kCurve], and their slopes by ln r to those of the
// roughness in the middle of alike ones, from which each is 6 % off: 1 / (1 / cost + 1 / (distance
// from the least / 6 %)^2), which is exact where costs are a parabola.
void ofLikeTexels(std::span<float> cost, std::span<float> slope);

// The costs of like-looking texels within `neighbour_px`, and of `before`, are added up: what one
// texel's lights leave open, another's decide. Fills ln r. Strips of columns in parallel; O(texels
// kCurve).
void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress);
// The same of the specular reflectance, once the roughness is settled.
void poolSpecular(const FitState& state, const std::vector<FitBefore>& before,
                  const MultiLightOptions& options, PriorMaps& prior, Progress& progress);

}  // namespace patina::brdf
