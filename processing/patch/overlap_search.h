// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the source blocks that agree best with what already lies under a block to be placed:
// cost(x,y) = sum over known texels of |F(x+i, y+j) - target(i,j)|^2, for every corner (x,y).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/patch/spectra.h"

namespace patina::patch {

// What is known of the block. Texels that are not known are not read.
struct Overlap {
  ImageView<const float> target;        // [block h][block w][k]
  ImageView<const std::uint8_t> known;  // [block h][block w]; 0: not known
};

struct SearchTerms {
  double tolerance = 0.1;  // candidates cost at most (1 + tolerance) times the least
  double floor = 0;        // added to every cost, so that a perfect match does not silence the rest
  // [corner rows][corner columns], at least 1, multiplies the cost; infinity: not allowed. May be
  // empty: 1 everywhere.
  ImageView<const float> weight;
};

struct Candidate {
  int x = 0, y = 0;  // corner in the source
  double cost = 0;   // weight * (floor + squared distance)
};

// Exact: the set is what brute force finds. Correlations by FFT over the leading channels give a
// lower bound of every cost, their rounding allowed for; who may still be within is summed
// directly. So no choice hangs on rounding, on the number of threads or on how many channels were
// correlated. O(channels * h*w log(h*w)) a query.
class OverlapSearch {
 public:
  // `features` [h][w][k], borrowed; earlier channels should carry more (as the scores of an SVD
  // do).
  OverlapSearch(ImageView<const float> features, SizePx block);

  // In raster order; empty only where no corner is allowed. Not thread-safe: it learns how many
  // channels pay, which does not change what it finds.
  std::vector<Candidate> candidates(const Overlap& overlap, const SearchTerms& terms);

  SizePx corners() const { return corners_; }  // corners (x,y): 0 <= x < corners().width ...
  double squaredDistance(const Overlap& overlap, int x, int y) const;

 private:
  struct Run {  // of known texels in a row of the block
    int y, first, end;
  };
  static std::vector<Run> runsOf(ImageView<const std::uint8_t> known);
  void correlateAtLeast(int channels);
  // Runs and energies of a mask; one that comes again costs nothing.
  void prepare(ImageView<const std::uint8_t> known);
  // Fills bounds_ and row_least_: what a corner costs at the least, weighted.
  void lowerBounds(const Overlap& overlap, const SearchTerms& terms);
  // By how much rounding may lift a bound, from the targets' squares by channel.
  double slackOf(std::span<const double> squares) const;
  std::vector<Candidate> atMost(double limit) const;  // by bound
  void learnFrom(std::size_t survivors);
  // As squaredDistance(); stops with something above `limit` once it is above it.
  double distanceUpTo(ImageView<const float> target, std::span<const Run> runs, int x, int y,
                      double limit) const;

  ImageView<const float> features_;
  SizePx block_, corners_;
  Spectra spectra_;
  int correlated_ = 0;         // leading channels of which spectra are held
  double survivors_mean_ = 0;  // of the last queries, roughly
  std::vector<Spectra::Spectrum> channel_;
  std::vector<double> channel_norm_;       // of the plane, for the rounding bound
  std::vector<float> energy_plane_;        // sum of squares of the leading channels, a texel
  std::vector<Spectra::Spectrum> energy_;  // one: of that
  double energy_norm_ = 0;
  Image<std::uint8_t> known_;  // of the last query
  std::vector<Run> runs_;
  int known_channels_ = 0;  // that energies_ and target_ are of
  std::int64_t known_texels_ = 0;
  Spectra::Plane energies_;             // [corner rows][corner columns]
  std::vector<Spectra::Plane> target_;  // [block h][padded w] a channel, zero where not known
  Spectra::Room room_;
  Spectra::Plane bounds_;         // [corner rows][corner columns]
  std::vector<float> row_least_;  // the least bound of each row of corners
};

}  // namespace patina::patch
