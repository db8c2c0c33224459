// SPDX-License-Identifier: GPL-3.0-or-later
// Z = T^t T Omega for a random Omega: its columns span nearly the leading right singular vectors of
// T. Inside this room only.
#pragma once

#include <span>
#include <vector>

#include "processing/decomposition/sample_block.h"

namespace patina::decomposition {

class RangeSketch {
 public:
  // `columns` of Omega.
  RangeSketch(Index n, Index columns);
  // Products in float a panel, their sum in double: what is small beside the first singular value
  // is not lost in rounding. A sum belongs to a place in the block, not to a thread.
  void add(const SampleBlock& block);
  // An orthonormal basis [n][columns] of the range of W (T - 1 mean^t)^t (T - 1 mean^t) Omega.
  std::vector<double> basis(Index m, std::span<const double> mean,
                            std::span<const float> weight) const;

 private:
  Index n_, columns_;
  std::vector<float> omega_;               // [n][columns]
  std::vector<std::vector<double>> sums_;  // by panel of a block: [n][columns]
};

// [m][l]: scores of all texels on `projection` [n][l], less `offset` [l]; and S^t S.
class Scores {
 public:
  Scores(Index m, Index l) : l_(l), values_(static_cast<std::size_t>(m * l)) {}
  void add(Index first, const SampleBlock& block, Index n, std::span<const float> projection,
           std::span<const float> offset);
  std::vector<double> gram() const;  // [l][l], lower triangle
  // S R, R [l][k], k <= l.
  std::vector<float> rotated(std::span<const float> rotation, Index k) &&;
  std::vector<float> taken() && { return std::move(values_); }

 private:
  Index l_;
  std::vector<float> values_;
};

}  // namespace patina::decomposition
