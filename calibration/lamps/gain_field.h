// SPDX-License-Identifier: GPL-3.0-or-later
// What a lamp gives every place of the picture: a smooth polynomial (Legendre, of a total degree)
// through the picture of a white or grey target under one lamp, one a channel. Levels are linear
// and free of black and ambient light; vignetting may be in them when it is in frames too.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct FieldOptions {
  int degree = 4;             // total, 0 to 8
  double clip_sigma = 4;      // blocks beyond this are left out: dirt, text, scratches; > 1
  double level_least = 0.02;  // of the target, share of full scale
  double level_most = 0.98;   // where channels begin to clip
  double cover_least = 0.5;   // of the picture's width and height that the target must span, (0, 1]
  double residual_most = 0.02;  // relative RMS: more is no even target, (0, 1)
  void check() const;           // throws CalibrationError(kUsage)
};
struct FieldReport {
  int blocks = 0, left_out = 0;              // of texels, that the fit goes through
  double residual_rms = 0;                   // relative
  double cover_width = 0, cover_height = 0;  // share of the picture that the target spans
  std::array<double, 3> mean{};              // over the picture
  double lowest = 0, highest = 0;            // over the picture, of the mean
};
struct LampField {
  SizePx size;
  int channels = 0, degree = 0;
  std::vector<double> coefficients;  // [c][k]; k: degrees (i in x, j in y), i + j <= degree
  FieldReport report;
};
// `regions`: where the target shows; none: all over. Throws CalibrationError(kBadData): too dark,
// clipped, spans too little, is no even target. O(texels).
LampField fitLampField(ImageView<const float> target, std::span<const RectPx> regions,
                       const FieldOptions& options, Progress& progress);
Image<float> paintField(const LampField& field);  // [h][w][c], never below a thousandth of its mean

}  // namespace patina::calibration
