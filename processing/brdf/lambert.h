// SPDX-License-Identifier: GPL-3.0-or-later
// Lambert's diffuse reflectance: f = albedo / pi [1/sr] (J. H. Lambert, Photometria, 1760).
#pragma once

namespace patina::brdf {

constexpr float kPi = 3.14159265f;
constexpr float kInversePi = 0.318309886f;

constexpr float lambert(float albedo) { return albedo * kInversePi; }

}  // namespace patina::brdf
