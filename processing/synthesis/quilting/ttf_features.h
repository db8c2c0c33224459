// SPDX-License-Identifier: GPL-3.0-or-later
// What blocks of a TTF are compared by: every texel's whole history in a few numbers (Enrique et
// al. 2005, equations 4 and 5).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processing/decomposition/temporal_svd.h"
#include "processing/synthesis/quilting/low_frequency.h"
#include "processing/ttf/ttf_file.h"

namespace patina::quilting {

// A TTF as it is quilted: with its low frequency taken out, or as it is. Borrows both.
class QuiltingSource {
 public:
  QuiltingSource(const ttf::TtfReader& input, const LowFrequency* low_frequency)
      : input_(input), low_frequency_(low_frequency) {}
  const ttf::TtfInfo& info() const { return input_.info(); }
  SizePx size() const { return {info().width, info().height}; }
  Image<std::uint16_t> frame(int t) const;
  Image<float> linearFrame(int t) const;
  std::vector<std::uint16_t> block(RectPx region) const;  // of all frames: [t][y][x][c]
  // Are samples codes of 8 bits that nothing is done to? Then they can be had as they are.
  bool isCoded() const { return info().type == ttf::SampleType::kU8 && !low_frequency_; }
  void codedBlock(RectPx region, std::vector<std::uint8_t>& codes) const;

 private:
  const ttf::TtfReader& input_;
  const LowFrequency* low_frequency_;
};

struct TtfFeatures {
  Image<float> features;      // [h][w][rank]: weighted coefficients of each texel's whole history
  std::vector<float> basis;   // [frames][channels][rank]
  std::vector<float> mean;    // [frames][channels], taken off, weighted
  std::vector<float> weight;  // of each frame
  double relative_error = 0;  // of T so weighted
  std::vector<double> error_of_rank = {};  // the same, of rank 1, 2 ...: at least to the rank's
  // A texel's displayed value is about (mean + basis . features) / weight.
};
// Time and colour together are the columns of T (equation 4): n = frames * channels. Samples are
// taken as displayed (sRGB), since a seam is seen there, and each frame is weighted by (1 + q) S /
// (s + q S), s its contrast (standard deviation), S the greatest, q = 0.2: a seam is seen against
// what else its frame shows, so that faint frames count too. Reads the
// input once, short sequences twice.
TtfFeatures ttfFeatures(const QuiltingSource& source, int rank_max,
                        std::optional<double> rank_error, Progress& progress);
// The same from a decomposition of every channel by itself, rank_max over channels components each
// (at least one), side by side in `features`; frames are weighted as above. Reads the input once
// more and twice a channel.
TtfFeatures ttfFeaturesApart(const QuiltingSource& source, int rank_max,
                             std::optional<double> rank_error, Progress& progress);

}  // namespace patina::quilting
