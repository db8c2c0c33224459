// SPDX-License-Identifier: GPL-3.0-or-later
// Where the fit gets sixteen texels side by side from. Only the fit includes this.
#pragma once

#include <algorithm>
#include <vector>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf {

// One row's sixteen texels from `x0` on; those beyond the edge repeat the last. Thread-bound;
// samples and options outlive it.
class FitTile {
 public:
  FitTile(const std::vector<FitSample>& samples, const MultiLightOptions& options);

  lanes::Samples& lanes() { return lanes_; }
  int channels() const { return channels_; }
  int column(int x0, int k) const { return std::min(x0 + k, size_.width - 1); }
  // Light and level of every picture there; noise 0 where a level is clipped or not known.
  void load(int x0, int y);
  // Of a channel, as loaded; 0 where the noise is.
  const lanes::Lane& colour(std::size_t picture, int channel) const {
    return colours_[picture * static_cast<std::size_t>(channels_) +
                    static_cast<std::size_t>(channel)];
  }
  // What kd and ks of a channel come from: its levels, but for Schlick's part of the lobe, times
  // the diffuse part and times the lobe.
  struct Products {
    lanes::Lane diffuse, gloss;
  };
  Products productsOf(int channel) const;

 private:
  void put(std::size_t i, int k, const LightRay& ray);
  void putLevel(std::size_t i, int k, std::span<const float> texel);

  const std::vector<FitSample>& from_;
  const MultiLightOptions& options_;
  SizePx size_;
  int channels_;
  lanes::Samples lanes_;
  std::vector<lanes::Lane> colours_;  // [picture][channel]
};

}  // namespace patina::brdf
