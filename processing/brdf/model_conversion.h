// SPDX-License-Identifier: GPL-3.0-or-later
// From one model's specular strength and roughness to another's that looks most alike, by fitting:
// the least-squares distance of (n.l) f_s over half vectors and lights at three angles of view
// (0, 35, 60 degrees), with the strength solved inside. Conventions of roughness: alpha; perceptual
// = sqrt(alpha); sigma of the simplified Torrance-Sparrow lobe.
#pragma once

#include "processing/brdf/brdf_file.h"
#include "processing/brdf/lobe.h"

namespace patina::brdf {

// `roughness` is alpha, or sigma for Torrance-Sparrow. kWardAnisotropic is taken as isotropic,
// kLambert has no lobe and must not be asked for one.
Lobe lobeOf(Model model, const LobeCosines& c, float roughness);

struct SpecularPart {
  double specular = 0;   // f0 (GGX), ks (Ward) or Ks* (Torrance-Sparrow), >= 0
  double roughness = 1;  // alpha or sigma, above 0
};
struct Conversion {
  SpecularPart part;
  double relative_error = 0;  // RMS difference over RMS of what was to be met, in [0,1]
};
// O(4000) evaluations of both models. `part.roughness` in [0.02, 1] (sigma to 3).
Conversion convert(const SpecularPart& part, Model from, Model to);

double alphaFrom(double roughness, RoughnessKind kind);  // of kAlpha and kPerceptual
double roughnessFrom(double alpha, RoughnessKind kind);

}  // namespace patina::brdf
