// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the source blocks that agree best with what already lies under a block to be placed:
// cost(x,y) = sum over known texels of |F(x+i, y+j) - target(i,j)|^2, for every corner (x,y).
#pragma once

#include <cstdint>
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
  // Fills bounds_; returns by how much a bound may lie above the true cost (rounding).
  double lowerBounds(const Overlap& overlap);
  void correlateAtLeast(int channels);
  // The energy of the leading channels under the known texels, at every corner.
  void prepareEnergies(ImageView<const std::uint8_t> known);
  // As squaredDistance(); stops with something above `limit` once it is above it.
  double distanceUpTo(const Overlap& overlap, int x, int y, double limit) const;

  ImageView<const float> features_;
  SizePx block_, corners_;
  Spectra spectra_;
  int correlated_ = 0;  // leading channels of which spectra are held
  std::vector<Spectra::Spectrum> channel_;
  std::vector<double> channel_norm_;  // of the plane, for the rounding bound
  std::vector<float> energy_plane_;   // sum of squares of the leading channels, a texel
  Spectra::Spectrum energy_;
  double energy_norm_ = 0;
  Image<std::uint8_t> known_;  // of the last query: a mask that comes again costs nothing
  int known_channels_ = 0;     // that energies_ are of
  std::int64_t known_texels_ = 0;
  Spectra::Plane energies_;
  std::vector<Spectra::Spectrum> target_;  // of a query: kept, so that its memory is
  Spectra::Spectrum sum_;
  Spectra::Plane bounds_;  // [padded h][padded w]
};

}  // namespace patina::patch
