// SPDX-License-Identifier: GPL-3.0-or-later
// Y = T Omega and Z = T^t Y in one pass: T projected on the range of Y is Y (Y^t Y)^-1 Z^t, whose
// singular value decomposition costs little. Of many texels Z and its Y^t Y are of some, spread by
// chance: they say as well how T hangs on Y. Inside this room only.
#pragma once

#include <span>
#include <vector>

#include "processing/decomposition/sample_block.h"

namespace patina::decomposition {

// [n][columns], normally distributed.
std::vector<float> randomColumns(Index n, Index columns);

struct Range {
  Index first, count;  // texels
};

// Of all texels on some vectors [n][l], less an offset [l].
class Scores {
 public:
  Scores(Index m, Index l) : m_(m), l_(l), values_(static_cast<std::size_t>(m * l)) {}
  void add(Index first, const SampleBlock& block, Index n, std::span<const float> vectors);
  void subtract(std::span<const double> offset);
  // S^t S [l][l] of some texels, lower triangle; summed in the order of the ranges.
  std::vector<double> gram(std::span<const Range> of) const;
  // S R [m][k], R [l][k], k <= l.
  std::vector<float> rotated(std::span<const float> rotation, Index k) const;
  std::vector<float> byTexel() const;  // [m][l]
  const float* from(Index texel) const { return values_.data() + texel; }
  Index stride() const { return m_; }

 private:
  Index m_, l_;
  std::vector<float> values_;  // [l][m]: BLAS fills rows of many texels faster than of few scores
};

class RangeSketch {
 public:
  // `omega` [n][columns].
  RangeSketch(Index m, Index n, std::vector<float> omega);
  // Products in float a panel, their sum in double: what is small beside the first singular value
  // is not lost in rounding. A sum belongs to a place in the block, not to a thread.
  void add(Index first, const SampleBlock& block);

  struct Factors {                         // falling; [columns] wide, zeros beyond T's rank
    std::vector<double> squares;           // of the singular values
    std::vector<double> basis;             // V [n][columns]
    std::vector<double> rotation;          // [columns][columns]: Y times it is U S
    std::vector<double> squares_on_omega;  // of T on W^-1 Omega alone: what one step less gives
  };
  // Of (T - 1 mean^t) W. Once: the scores are centred.
  Factors factors(std::span<const double> mean, std::span<const float> weight);
  const Scores& scores() const { return scores_; }

 private:
  struct Sums {
    std::vector<double> products, samples;  // [n][columns] of Z, [n] of T's rows
  };
  bool isSampled() const;
  bool teaches(Index first) const;  // the panel that begins there
  std::vector<double> product(std::span<const double> mean, std::span<const double> offset,
                              std::span<const float> weight) const;
  // Against Omega^t W^-2 Omega; zeros where Omega's columns hang together.
  std::vector<double> ritzValues(std::vector<double> gram, std::span<const float> weight) const;

  Index m_, n_, columns_;
  std::vector<float> omega_;
  Scores scores_;
  std::vector<Range> taught_;  // panels that Z is of
  std::vector<Sums> sums_;     // by panel of a block
};

}  // namespace patina::decomposition
