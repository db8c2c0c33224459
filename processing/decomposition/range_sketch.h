// SPDX-License-Identifier: GPL-3.0-or-later
// Z = T^t T Omega: its columns span the leading right singular vectors of T better than those of
// Omega did. Inside this room only.
#pragma once

#include <span>
#include <vector>

#include "processing/decomposition/sample_block.h"

namespace patina::decomposition {

// [n][columns], normally distributed.
std::vector<float> randomColumns(Index n, Index columns);

class RangeSketch {
 public:
  // `omega` [n][columns].
  RangeSketch(Index n, std::vector<float> omega);
  // Products in float a panel, their sum in double: what is small beside the first singular value
  // is not lost in rounding. A sum belongs to a place in the block, not to a thread.
  void add(const SampleBlock& block);

  struct Range {
    std::vector<double> basis;  // [n][columns], orthonormal
    // Of T W on W^-1 Omega (Ritz values), rising: what was known before T was seen.
    std::vector<double> squared_singular_values;
  };
  // Of T standing for W (T - 1 mean^t)^t (T - 1 mean^t) Omega.
  Range range(Index m, std::span<const double> mean, std::span<const float> weight) const;

 private:
  // Omega^t Z against Omega^t W^-2 Omega; zeros where Omega's columns hang together.
  std::vector<double> ritzValues(const std::vector<double>& z, std::span<const float> weight) const;

  Index n_, columns_;
  std::vector<float> omega_, omega_by_column_;
  std::vector<std::vector<double>> sums_;  // by panel of a block: [n][columns]
};

// Scores of all texels on `projection` [n][l], less `offset` [l]; and S^t S.
class Scores {
 public:
  Scores(Index m, Index l) : m_(m), l_(l), values_(static_cast<std::size_t>(m * l)) {}
  void add(Index first, const SampleBlock& block, Index n, std::span<const float> projection,
           std::span<const float> offset);
  std::vector<double> gram() const;  // [l][l], lower triangle
  // S R [m][k], R [l][k], k <= l.
  std::vector<float> rotated(std::span<const float> rotation, Index k) const;
  std::vector<float> byTexel() const;  // [m][l]

 private:
  Index m_, l_;
  std::vector<float> values_;  // [l][m]: BLAS fills rows of many texels faster than of few scores
};

}  // namespace patina::decomposition
