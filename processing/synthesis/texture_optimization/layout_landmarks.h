// SPDX-License-Identifier: GPL-3.0-or-later
// What landmarks cost where blocks are laid (layout.h). A landmark that is seen twice at a glance
// gives the copying away; one that is left out takes its variance with it. So copies keep a side of
// the sample apart, and as many are sought as even use would show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/synthesis/texture_optimization/landmarks.h"

namespace patina::texture_optimization {

class LayoutLandmarks {
 public:
  LayoutLandmarks() = default;  // none
  // Of blocks of `block` texels' side at `places` (y * width + x) of a sample of `source`;
  // `even_copies` are the target's texels over the sample's.
  LayoutLandmarks(const Landmarks& landmarks, SizePx source, int block,
                  std::span<const std::int32_t> places, float even_copies);

  // How much mismatch weighs at a texel of the sample: more where it cuts a landmark.
  float weight(std::size_t texel) const { return weights_.empty() ? 1 : weights_[texel]; }

  // A block that shows `place` is in the target from now on, or no more.
  void appear(std::int32_t place) { count(place, 1); }
  void vanish(std::int32_t place) { count(place, -1); }

  // To `costs` [h][w] of a block at each place: of the landmarks shown by a block at `place`, which
  // lies so many texels to the right and below; not where both blocks go on in one copy.
  void addNear(std::int32_t place, int right, int below, std::span<float> costs) const;

  // From `costs`: what the landmarks that are shown less often than even use would show are owed.
  void takeOwed(std::span<float> costs) const;

 private:
  // What a block at `place` shows of a landmark: its share and the middle of it, in the block.
  struct Part {
    std::size_t landmark;
    std::int32_t place;
    float share, x, y;
  };
  // All of one landmark, four at a time; the last of them show nothing.
  struct Parts {
    std::vector<std::int32_t> place = {};
    std::vector<float> share = {}, x = {}, y = {};

    void add(const Part& part);
  };

  Part partOf(const std::vector<float>& share, std::int32_t place) const;
  void count(std::int32_t place, float sign);

  SizePx source_{};
  int block_ = 0;
  float even_ = 0;
  std::vector<float> weights_;  // [h][w] of the source
  std::vector<Parts> landmarks_;
  std::vector<float> copies_;                // of each landmark, that are shown
  std::vector<std::vector<Part>> parts_at_;  // by place in the source
};

}  // namespace patina::texture_optimization
