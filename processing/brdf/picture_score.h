// SPDX-License-Identifier: GPL-3.0-or-later
// How alike two pictures are: PSNR over all samples, and SSIM (Wang et al. 2004: Gaussian window of
// sigma 1.5 over 11x11, mean over channels and over places where the window fits).
#pragma once

#include "processing/image/image.h"

namespace patina::brdf {

// Of samples whose full scale is 1, values clamped to [0,1]; infinite where they are equal.
double meanSquareError(ImageView<const float> a, ImageView<const float> b);
double psnrDb(double mean_square_error);
double ssim(ImageView<const float> a, ImageView<const float> b);  // 1: the same. 11x11 at least

}  // namespace patina::brdf
