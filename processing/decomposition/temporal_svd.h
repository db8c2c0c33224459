// SPDX-License-Identifier: GPL-3.0-or-later
// Singular value decomposition of a tall matrix T [m texels][n time samples], streamed by row
// blocks through its Gram matrix (method of snapshots): T ~ U S V^t, U S = T V. Enrique et al.
// 2005, (4)-(5).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "processing/image/progress.h"

namespace patina::decomposition {

// Fills `rows` (count * n floats, row-major) with rows [first, first + count) of T. Called from one
// thread, in order, twice over all rows.
using RowSource =
    std::function<void(std::int64_t first, std::int64_t count, std::span<float> rows)>;

struct SvdOptions {
  int rank = 15;          // at most min(m, n)
  double rank_error = 0;  // > 0: the least rank whose relative RMS error is below it, up to rank
  std::int64_t block_rows = 4096;  // at most; fewer where n is large (64 MiB of rows)
  bool centre = false;             // subtract the mean row first
  void check(std::int64_t m, std::int64_t n) const;  // throws ProcessingError(kUsage)
};
struct TemporalSvd {
  int rank = 0;
  std::vector<float> scores;            // [m][rank]: rows of U, weighted by the singular values
  std::vector<double> singular_values;  // [n], falling
  std::vector<float> basis;             // [n][rank]: V; each column's largest entry is positive
  std::vector<float> mean;              // [n], zeros unless centred
  double relative_error = 0;            // RMS of T - U S V^t over RMS of T (T centred, if asked)
};
// Gram matrix in double, LAPACK dsyevd. O(m n^2 + n^3) time; memory 3 n^2 doubles, one block of
// rows and the scores. Same bytes for any number of threads. Throws ProcessingError(kBadData) where
// T holds a NaN or an infinity.
TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const RowSource& rows,
                        const SvdOptions& options, Progress& progress);

}  // namespace patina::decomposition
