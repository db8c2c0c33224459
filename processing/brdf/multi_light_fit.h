// SPDX-License-Identifier: GPL-3.0-or-later
// From pictures of one surface under many lights to normal, diffuse colour, specular reflectance
// and roughness of every texel (Meister et al. 2021, sec. 4.1: eqs 1, 2 or 6, 7).
//
//   picture_i = (kd + pi f_s(n, l_i, v_i; ks, r)) (n.l_i) E_i
//
// kd, ks [0,1], E irradiance across the light's rays: 1 shows a white diffuser that faces the light
// as 1. Start: photometric stereo on the middle quantiles of each texel's levels, so that shadows
// and highlights do not decide, and a scan over the roughness. Then variable projection (Golub and
// Pereyra 1973, Kaufman's form): kd and ks, the linear part, are solved inside (2x2, not below
// zero); Levenberg and Marquardt turn the normal and scale the roughness. Weights: the sensor's
// noise, times Cauchy's of the residual in units of the texel's own spread (inter-reflection).
// Left out: clipped levels, n.l <= 0 (attached shadow), levels far below the prediction (cast).
// With `deep_shadows` a texel that is not met is tried from a mirror's normal, and as one that most
// lamps do not reach: then all that is darker than predicted is shadow (lane_rivals.cpp); and
// levels beside a shadow's edge are left out (shadow_map.h). Where a highlight is narrower than the
// lamps' spacing, or as wide as the diffuse part, ks and r are not known: a second pass holds them
// to those that like-coloured neighbours tell together (roughness_pool.h), and to `before`, other
// time steps, each counted by its confidence.
//
// The normal and roughness are found on the mean of the channels, kd and ks then for each. The
// anisotropic Ward model is fitted on top of the isotropic one (anisotropic_fit.h).
// 16 texels at a time, rows in parallel (oneTBB): the same bytes for any number of threads and any
// SIMD path. O(texels pictures).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processing/brdf/brdf_file.h"
#include "processing/brdf/pixel_maps.h"
#include "processing/brdf/surface_light.h"
#include "processing/image/progress.h"

namespace patina::brdf {

struct FitSample {
  ImageView<const float> picture;  // [h][w][1 or 3] linear, black and ambient light taken off;
                                   // NaN: this texel is not known
  SurfaceLight light;
  Vec3 view{0, 0, 1};  // unit, to the camera
};

// sigma^2 = floor^2 + shot level + (gain level)^2, levels in units of the pictures. The gain's is
// the lamp's: all texels of a picture have it together, and neighbours do not average it away.
struct FitNoise {
  float floor = 0.002f, shot = 1e-5f, gain = 0.005f;
};
struct MultiLightOptions {
  Model model = Model::kGgx;
  FitNoise noise;
  float saturated = 0.995f;   // levels from here on are clipped
  float mm_per_texel = 1;     // for near lights
  int rounds = 3;             // of weights, 1 to 10
  int steps = 4;              // of Levenberg and Marquardt a round, 1 to 50
  bool neighbours = true;     // false: a texel is held to `before` alone, if there is any
  int neighbour_px = 16;      // how far it looks, 1 to 256
  float like_colour = 0.04f;  // difference of diffuse colour that still counts as like
  // How far specular reflectance is expected above 0.025, a dielectric's (below: 0.3 of that): what
  // decides where a wide lobe and the diffuse part are one within the noise. Lamps that tell
  // overrule it. (0,1]; not of Torrance and Sparrow's model, whose strength is no reflectance.
  float specular_spread = 0.02f;
  // Pictures are a mosaic, [h][w][1]: colours of its 2x2 cell. So are the maps of diffuse and
  // specular colour then (pixel_maps.h); like-looking are neighbours of the same colour.
  std::optional<Filters> filters;
  // Whether what is not met is begun anew, from a mirror's normal and as what most lamps do not
  // reach. For pixels, which light reaches or does not; of texels whose light the model does not
  // meet anyhow (a photograph's of gilding) it takes misfit for shadow.
  bool deep_shadows = false;
  void check() const;  // throws ProcessingError(kUsage)
};

// Of another time step, or of a fit at hand: what ks and r are held to, by its confidence.
struct FitBefore {
  ImageView<const float> specular;    // [h][w][1 or 3]
  ImageView<const float> roughness;   // [h][w][1]
  ImageView<const float> confidence;  // [h][w][1], [0,1]
};

struct MultiLightReport {
  std::int64_t texels = 0;
  std::int64_t black = 0;      // no light reached them: kd = 0, the normal is up, confidence 0
  std::int64_t few = 0;        // fewer than 4 usable levels: Lambert's with what there is
  std::int64_t confident = 0;  // confidence of at least a half
  double residual_rms = 0;     // over all levels that counted, in units of the pictures
  double left_out = 0;         // share of levels left out: clipped or in shadow
};
struct MultiLightFit {
  BrdfMaps maps;  // extra: Confidence (of specular and roughness), Residual (RMS of the texel)
  // [h][w]: 1 where five levels or more counted and, with `deep_shadows`, no shadow's edge divides
  // the pixel and it is no darker than materials are; else it is what little there is.
  Image<std::uint8_t> told;
  MultiLightReport report;
};

// Throws ProcessingError(kBadData): no pictures, sizes or channels that differ, a light without
// direction or behind the surface, all of them behind or in one plane with the middle of the
// surface (normals cannot be told then), fewer than 6 (Lambert: 3).
MultiLightFit fitManyLights(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                            const std::vector<FitBefore>& before, Progress& progress);

}  // namespace patina::brdf
