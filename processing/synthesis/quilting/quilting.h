// SPDX-License-Identifier: GPL-3.0-or-later
// Cuboid quilting of a time-varying texture after Enrique et al. 2005, sections 5.1 and 5.2: a
// block is small in space and spans the whole sequence; one seam for all frames (equation 3);
// blocks are compared in weighted SVD space (equations 4 and 5); real data are copied, never a
// reconstruction. Beyond the paper: seams are minimum cuts of any shape, and a source region is
// kept from being shown twice close together.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::quilting {

// Slow variation over the sample (section 5.3).
enum class LowFrequencyUse {
  kKeep,     // is quilted with the rest: real data, copied
  kDrop,     // is taken out first: the result is even
  kRestore,  // is taken out first and put back stretched over the result
};

class TimeWarps;
struct SeamMetric;

struct PointPx {
  int x = 0, y = 0;
};

struct QuiltingOptions {
  SizePx size{1024, 1024};                // of the result
  SizePx block_px{0, 0};                  // width x height, tall for growing things; 0x0: a square
                                          // of a sixth of the source's smaller side, 24 to 160
  int overlap_px = 0;                     // along both sides; 0: two fifths of the block's, each
  int svd_rank = 15;                      // at most; or fewer where error allows
  std::optional<double> rank_error = {};  // relative RMS: rank chosen by error instead
  bool channels_apart = false;            // each decomposed by itself, svd_rank for all (TTF only)
  double tolerance = 0.2;                 // candidates within (1 + tolerance) of the best
  int seam_sweeps = 2;    // passes over all blocks in which seams already cut are cut anew, 0 to 20
  bool tile = false;      // the result wraps around, left to right, top to bottom
  double verbatim = 0.7;  // share of the source's sides that one copy may span; [0,1]
  double repetition_penalty = 1.0;  // on source regions shown nearby; 0: none
  LowFrequencyUse low_frequency = LowFrequencyUse::kKeep;
  double low_frequency_px = 0;  // Gaussian sigma of what counts as slow; 0: a block's smaller side
  int jitter_frames = 0;        // each block wanders about its true time, this far (equation 7)
  int jitter_event_frames = 0;  // each block changes early or late, by up to this
  bool blend_auto = false;  // the least reach of up to 32 px under which seams are no steeper than
                            // the rest, where they are (TTF only)
  double blend_px = 0;      // reach of a correction beside seams, 0 to 256; 0: none, pure copies
  std::optional<PointPx> first = {};  // source corner of the first block; nothing: drawn
  Image<std::uint8_t> keep = {};      // [h][w] of the result, not 0: stays as it is; may be empty
  PointPx keep_from{};                // the source texel that what stays would show at 0,0
  std::vector<RectPx> parts = {};     // of the source, where blocks may come from; empty: all of it
  std::uint64_t seed = 1;
  void check(SizePx source) const;       // throws ProcessingError: field, value, range
  SizePx blockFor(SizePx source) const;  // the defaults resolved
  SizePx overlapFor(SizePx block) const;
  double lowFrequencyFor(SizePx block) const;
};

// Which source texel each result texel copies: int32 (x, y). The whole result follows from it.
struct Quilt {
  Image<std::int32_t> source_xy;  // [h][w][2]
  Image<std::int32_t> block;      // [h][w][1], index of the block placed there
  // [block][t]: the frame that a block shows at t. Empty: all show frame t.
  std::vector<std::vector<int>> times = {};

  int timeAt(int x, int y, int t) const { return times.empty() ? t : times[block.at(x, y)][t]; }
  // Do these two texels of the result, `step` apart, lie so in the source too, at one time?
  bool isWhole(int x, int y, int to_x, int to_y, int step_x, int step_y) const {
    if (!times.empty() && block.at(x, y) != block.at(to_x, to_y)) return false;
    return source_xy.at(to_x, to_y, 0) - source_xy.at(x, y, 0) == step_x &&
           source_xy.at(to_x, to_y, 1) - source_xy.at(x, y, 1) == step_y;
  }
};
struct QuiltingReport {
  int blocks = 0, rank = 0;
  double svd_error = 0;       // relative RMS of the rank used
  double seam_cost_mean = 0;  // squared difference of the two sides along seams, a texel
  double seam_ratio = 0;      // gradient across seams / gradient inside, in feature space
  // Of the result as displayed (TTF only): the median of nine frames; and in the worst of them of
  // means over 9x9 texels, along rows or columns, whichever shows seams more.
  double seam_ratio_frames = 0, seam_ratio_worst = 0;
  // The median again, over what the sources show at the very seams: steeper than their place?
  double seam_ratio_in_place = 0;
  double blend_px = 0;                     // of the correction made (TTF only)
  std::int64_t texels_recut = 0;           // that another block covers since seams were cut anew
  std::vector<double> part_shares = {};    // of the result's texels, by the part they come from
  std::vector<double> error_of_rank = {};  // relative RMS that rank 1, 2 ... would have (TTF only)
};

// `features` [h][w][k]: rows of U times the singular values (decomposition/temporal_svd.h).
// Pure in its inputs and seed, for any number of threads. Cost O(blocks * h*w*k) by FFT.
struct QuiltResult {
  Quilt quilt;
  QuiltingReport report;
};
// With `warps` every block takes the next time of its own: blocks are looked for at the true time,
// and joined and cut as they will be shown. With `metric` seams are judged by it.
QuiltResult quilt(ImageView<const float> features, const QuiltingOptions& options,
                  Progress& progress, TimeWarps* warps = nullptr,
                  const SeamMetric* metric = nullptr);

// Copies: result texel (x,y) of `frame` = frame at source_xy, whatever its time. Multi-threaded.
Image<std::uint16_t> applyQuilt(ImageView<const std::uint16_t> frame, const Quilt& quilt);
Image<float> applyQuilt(ImageView<const float> frame, const Quilt& quilt);

}  // namespace patina::quilting
