// SPDX-License-Identifier: GPL-3.0-or-later
// Cuboid quilting of a time-varying texture after Enrique et al. 2005, sections 5.1 and 5.2: a
// block is small in space and spans the whole sequence; one seam for all frames (equation 3);
// blocks are compared in weighted SVD space (equations 4 and 5); real data are copied, never a
// reconstruction.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::quilting {

struct QuiltingOptions {
  SizePx size{1024, 1024};           // of the result
  SizePx block_px{64, 64};           // width x height; tall for growing things
  int overlap_px = 0;                // 0: a quarter of the block's smaller side
  int svd_rank = 15;                 // at most; or fewer where error allows
  std::optional<double> rank_error;  // relative RMS: rank chosen by error instead
  double tolerance = 0.1;            // candidates within (1 + tolerance) of the best
  std::uint64_t seed = 1;
  void check(SizePx source) const;  // throws ProcessingError: field, value, range
};

// Which source texel each result texel copies: int32 (x, y). The whole result follows from it.
struct Quilt {
  Image<std::int32_t> source_xy;  // [h][w][2]
  Image<std::int16_t> block;      // [h][w][1], index of the block placed there
};
struct QuiltingReport {
  int blocks = 0, rank = 0;
  double svd_error = 0;       // relative RMS of the rank used
  double seam_cost_mean = 0;  // weighted squared difference along seams, a texel
  double seam_ratio = 0;      // gradient across seams / gradient inside, mean over frames sampled
};

// `features` [h][w][k]: rows of U times the singular values (decomposition/temporal_svd.h).
// Pure in its inputs and seed, for any number of threads. Cost O(blocks * h*w*k) by FFT.
struct QuiltResult {
  Quilt quilt;
  QuiltingReport report;
};
QuiltResult quilt(ImageView<const float> features, const QuiltingOptions& options,
                  Progress& progress);

// Copies: result texel (x,y) of `frame` = frame at source_xy. Multi-threaded.
Image<std::uint16_t> applyQuilt(ImageView<const std::uint16_t> frame, const Quilt& quilt);

}  // namespace patina::quilting
