// SPDX-License-Identifier: GPL-3.0-or-later
// From a camera's numbers to colours: XYZ under D50 = M * terms(r, g, b).
//
//   3x3     r g b
//   4x3     r g b 1                  an offset: true at one exposure only
//   root2   r g b sqrt(rg) sqrt(gb) sqrt(rb)
//   root3   root2, and the cube roots of rg^2 gb^2 rb^2 gr^2 bg^2 br^2 rgb
// Root polynomials scale with the exposure as the camera does: G. D. Finlayson, M. Mackiewicz,
// A. Hurlbert, "Color correction using root-polynomial regression", IEEE Transactions on Image
// Processing 24(5), 2015, section III. Numbers below zero have the root of zero.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/colour/colour_space.h"
#include "processing/image/image.h"

namespace patina::calibration {

enum class FitKind { k3x3, k4x3, kRoot2, kRoot3 };
constexpr std::array<FitKind, 4> kFitKinds{FitKind::k3x3, FitKind::k4x3, FitKind::kRoot2,
                                           FitKind::kRoot3};
constexpr int kTermsMax = 13;

std::string nameOf(FitKind kind);  // "3x3" "4x3" "root2" "root3"
std::optional<FitKind> fitNamed(const std::string& name);
int termCount(FitKind kind);
// Fills the first termCount(kind) of `terms`.
void fillTerms(FitKind kind, const Rgb& rgb, std::span<double, kTermsMax> terms);

struct ColourModel {
  FitKind kind = FitKind::k3x3;
  std::vector<double> xyz_from_terms;  // [3][termCount]; Y = 1 is a perfect diffuser at the chart
};
Xyz colourOf(const ColourModel& model, const Rgb& rgb);

enum class ColourSpace { kLinearSrgb, kXyz };  // D65 with the primaries of Rec. 709; D50
// In place, [h][w][3]. What the model says is multiplied by `level`. Throws
// CalibrationError(kBadData) for other channels. O(texels), multi-threaded; values outside the
// space stay negative.
void applyColour(ImageView<float> linear, const ColourModel& model, ColourSpace space,
                 double level = 1);

}  // namespace patina::calibration
