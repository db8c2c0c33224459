// SPDX-License-Identifier: GPL-3.0-or-later
// Singular value decomposition of a tall matrix T [m texels][n time samples], streamed by blocks of
// texels: T ~ U S V^t, U S = T V. Enrique et al. 2005, (4)-(5). Few columns: by the Gram matrix
// (method of snapshots), exact, in two passes. Many: T is projected on the range of T Omega, from
// T Omega and T^t T Omega of one pass (a Nystroem approximation of T^t T; Halko et al. 2011,
// section 5). We depart in Omega, which is random only for the first block and then learned from
// it, and in asking afterwards how far the singular values may be off: where that is too far, there
// is another pass, from what was found.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "processing/image/progress.h"

namespace patina::decomposition {

// Fills `block` [n][count] with texels [first, first + count) of T: a row is a sample of time, as
// frames lie in files. Called from one thread, in order, once or twice over all texels,
// rarely up to four times.
using SampleSource =
    std::function<void(std::int64_t first, std::int64_t count, std::span<float> block)>;
// The same in codes of 8 bits.
using CodeSource =
    std::function<void(std::int64_t first, std::int64_t count, std::span<std::uint8_t> block)>;

// What a column of T is multiplied by, from the mean and the variance of each over all texels;
// called after the first pass, and perhaps on the first block before.
using Weigh = std::function<std::vector<float>(std::span<const double> mean,
                                               std::span<const double> variance)>;

struct SvdOptions {
  int rank = 15;          // at most min(m, n)
  double rank_error = 0;  // > 0: the least rank whose relative RMS error is below it, up to rank
  double certain = 1e-4;  // of the first singular value: where n is large and others may be off by
                          // more, there is another pass
  std::int64_t block_texels = 4096;  // at most; fewer where n is large (64 MiB of samples)
  bool centre = false;               // subtract the mean row first
  Weigh weigh = {};                  // nothing: 1 everywhere
  void check(std::int64_t m, std::int64_t n) const;  // throws ProcessingError(kUsage)
};
struct TemporalSvd {
  int rank = 0;
  std::vector<float> scores;  // [m][rank]: rows of U, weighted by the singular values
  // Falling: all n, or where n is large the leading rank + 16 or a few more, those up to `rank`
  // within `certain` of the first.
  std::vector<double> singular_values;
  std::vector<float> basis;         // [n][rank]: V; each column's largest entry is positive. Zeros
                                    // where a singular value is 0 and n large
  std::vector<float> mean, weight;  // [n]; zeros unless centred, ones unless weighed
  std::vector<double> error_of_rank;  // [0] of rank 1 ...: RMS of T - U S V^t over RMS of T (T
                                      // centred and weighed, if asked); long as singular_values
  double relative_error = 0;          // of the rank chosen; where n is large below 1e-4 reads so
};
// O(m n min(n, rank)) time; memory one block of samples, the scores and 16 n (rank + 16) floats,
// or 3 n^2 doubles where n is small. Same bytes for any number of threads. Throws
// ProcessingError(kBadData) where T holds a NaN or an infinity.
TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const SampleSource& samples,
                        const SvdOptions& options, Progress& progress);
// Of samples that are codes, `step` each: equal but for rounding, and sooner, since floats are made
// of few at a time.
TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const CodeSource& codes, float step,
                        const SvdOptions& options, Progress& progress);
// Of samples that lie in memory, [n][m]: nothing is copied.
TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, std::span<const float> samples,
                        const SvdOptions& options, Progress& progress);

}  // namespace patina::decomposition
