// SPDX-License-Identifier: GPL-3.0-or-later
// The response of a camera that gives 8 bits: which light each code stands for, a colour. Measured
// from brackets, pictures of one still scene whose exposures are known.
// Papers: P. Debevec and J. Malik, "Recovering High Dynamic Range Radiance Maps from Photographs",
// 1997, equation 3; M. Robertson, S. Borman, R. Stevenson, "Estimation-theoretic approach to
// dynamic range enhancement using multiple exposures", 2003, section 3. Both are OpenCV's and
// give the start; by themselves they err by several percent where the pictures are noisy, as the
// one takes some hundred texels and both single codes. So the curve is fitted once more to the sums
// of light of all blocks (curve_fit.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

constexpr int kCodes = 256;

struct ResponseCurve {
  // Light of a code, 1 at the last; rises. Of grey pictures all three are the same.
  std::array<std::array<float, kCodes>, 3> light{};
};
struct Bracket {
  Image<std::uint8_t> codes;  // [h][w][1 or 3]
  double exposure_s = 0;      // 0: the lens covered
};
enum class ResponseMethod { kDebevecMalik, kRobertson };
struct ResponseOptions {
  ResponseMethod method = ResponseMethod::kRobertson;
  int samples = 150;       // Debevec-Malik: texels taken, 50 to 1000; time grows with the cube
  double smoothness = 10;  // Debevec-Malik: lambda, above 0 to 1000
  int iterations = 60;     // Robertson: 1 to 1000
  // Side of the blocks whose sums of light then give the curve once more, 1 to 64; 0: not at all.
  int block_px = 8;
  void check() const;  // throws CalibrationError(kUsage)
};
struct ResponseReport {
  int exposures = 0;
  double ratio = 0;  // longest over shortest
  // RMS over texels and exposures of one light's departure from the texel's mean, share of it.
  double residual = 0;
  std::array<int, 3> codes_seen{};  // of 256
  int block_sums = 0;               // of light, that two exposures or more share
  double fall_mended = 0;           // the largest step down that was levelled, of full scale
};
struct Response {
  ResponseCurve curve;
  ResponseReport report;
};
// Throws CalibrationError(kBadData) with what to shoot: fewer than 3 exposures, all alike (under
// two to one), unequal sizes, too few codes between black and white, a scene or light that moved (a
// residual above 10 %), a curve that falls by more than 5 %.
Response measureResponse(const std::vector<Bracket>& brackets, const ResponseOptions& options,
                         Progress& progress);

// Codes to light, [h][w][c] as given. O(texels), multi-threaded.
Image<float> linearBy(const ResponseCurve& curve, ImageView<const std::uint8_t> codes);

}  // namespace patina::calibration
