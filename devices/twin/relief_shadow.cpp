// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/relief_shadow.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"

namespace patina::devices::twin {

namespace {

constexpr int kSideMaxTexels = 8192;
constexpr int kBlock = 16;  // texels, all reached by single steps

}  // namespace

ReliefShadow::ReliefShadow(float x0_mm, float y0_mm, float x1_mm, float y1_mm, float texel_mm) {
  const auto texels = [&](float from, float to) {
    return std::clamp(static_cast<int>(std::ceil((to - from) / texel_mm)), 2, kSideMaxTexels);
  };
  grid_.size = {texels(x0_mm, x1_mm), texels(y0_mm, y1_mm)};
  grid_.texel_mm = texel_mm;
  const auto count = static_cast<std::size_t>(grid_.size.width) * grid_.size.height;
  grid_.x_mm.resize(count);
  grid_.y_mm.resize(count);
  for (int y = 0; y < grid_.size.height; ++y)
    for (int x = 0; x < grid_.size.width; ++x) {
      grid_.x_mm[grid_.index(x, y)] = x0_mm + (static_cast<float>(x) + 0.5f) * texel_mm;
      grid_.y_mm[grid_.index(x, y)] = y1_mm - (static_cast<float>(y) + 0.5f) * texel_mm;
    }
}

void ReliefShadow::setHeights(std::vector<float> heights) {
  heights_ = std::move(heights);
  highest_ = *std::max_element(heights_.begin(), heights_.end());
  const int across = (grid_.size.width + kBlock - 1) / kBlock,
            down = (grid_.size.height + kBlock - 1) / kBlock;
  Image<float> blocks(across, down, 1);
  std::fill(blocks.texels().begin(), blocks.texels().end(), -HUGE_VALF);
  for (int y = 0; y < grid_.size.height; ++y)
    for (int x = 0; x < grid_.size.width; ++x) {
      float& highest = blocks.at(x / kBlock, y / kBlock);
      highest = std::max(highest, heights_[grid_.index(x, y)]);
    }
  near_ = blocks;
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x)
      for (int by = std::max(y - 1, 0); by <= std::min(y + 1, down - 1); ++by)
        for (int bx = std::max(x - 1, 0); bx <= std::min(x + 1, across - 1); ++bx)
          near_.at(x, y) = std::max(near_.at(x, y), blocks.at(bx, by));
}

std::vector<float> ReliefShadow::visibility(const LampPlace& lamp) const {
  std::vector<float> seen(heights_.size());
  forRowBlocks(grid_.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < grid_.size.width; ++x) seen[grid_.index(x, y)] = at(x, y, lamp);
  });
  return seen;
}

// Offsets from the texel are small numbers: their shares of a texel keep their digits.
float ReliefShadow::at(int x, int y, const LampPlace& lamp) const {
  const std::size_t here = grid_.index(x, y);
  const float h = heights_[here];
  const auto dx = static_cast<float>(lamp.position_mm.x - grid_.x_mm[here]),
             dy = static_cast<float>(lamp.position_mm.y - grid_.y_mm[here]),
             dz = static_cast<float>(lamp.position_mm.z - h);
  const float across2 = dx * dx + dy * dy;
  const bool along_x = std::abs(dx) >= std::abs(dy);
  const float greater = along_x ? dx : dy, lesser = along_x ? dy : dx;
  if (std::abs(greater) < grid_.texel_mm) return 1;  // from straight above
  const float steps_a_mm = grid_.texel_mm / std::abs(greater);
  const float rise = dz * steps_a_mm;  // a step
  if (!(rise > 0)) return 1;
  const float penumbra = static_cast<float>(lamp.radius_mm) * steps_a_mm *
                         std::sqrt((across2 + dz * dz) / across2);  // a step
  // Where the ray is above all by more than its penumbra, nothing is in its way.
  const float climb = std::max(rise - penumbra, 1e-6f), above = (highest_ - h) / climb;
  if (above < 1) return 1;
  const float above_near = (near_.at(x / kBlock, y / kBlock) - h) / climb;
  const int room = static_cast<int>(std::min(above, std::abs(greater) / grid_.texel_mm));
  const float slope = lesser / greater;  // of the way, in texels a texel
  // Rows run down, y runs up.
  const int forward = (greater > 0) == along_x ? 1 : -1;
  const float drift = -slope * static_cast<float>(forward);
  const int here_lesser = along_x ? y : x, here_greater = along_x ? x : y;
  const int end_lesser = along_x ? grid_.size.height : grid_.size.width,
            end_greater = along_x ? grid_.size.width : grid_.size.height;
  const std::ptrdiff_t pitch_greater = along_x ? 1 : grid_.size.width,
                       pitch_lesser = along_x ? grid_.size.width : 1;
  float seen = 1;
  for (int k = 1; k <= room; k = nextShadowStep(k)) {
    if (k <= kBlock && static_cast<float>(k) > above_near) {
      k = kBlock;  // nothing near is that high
      continue;
    }
    const float offset = drift * static_cast<float>(k);
    const float whole = std::floor(offset), share = offset - whole;
    const int g = here_greater + forward * k, l = here_lesser + static_cast<int>(whole);
    if (g < 0 || g >= end_greater || l < 0 || l + 1 >= end_lesser) break;
    const float* low = heights_.data() + g * pitch_greater + l * pitch_lesser;
    const float blocker = low[0] + (low[pitch_lesser] - low[0]) * share;
    const auto steps = static_cast<float>(k);
    const float clearance = (h - blocker) + steps * rise;
    seen = std::min(seen, 0.5f + clearance / (2 * steps * penumbra));
    if (seen <= 0) return 0;
  }
  return seen;
}

GridReader::GridReader(const SampleGrid& from, const SampleGrid& to)
    : from_width_(from.size.width), to_width_(to.size.width), places_(to.x_mm.size()) {
  const float x0 = from.x_mm.front(), y0 = from.y_mm.front();
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const float x = std::clamp((to.x_mm[k] - x0) / from.texel_mm, 0.0f,
                               static_cast<float>(from.size.width) - 1.001f),
                y = std::clamp((y0 - to.y_mm[k]) / from.texel_mm, 0.0f,
                               static_cast<float>(from.size.height) - 1.001f);
    const float column = std::floor(x), row = std::floor(y);
    places_[k] = {static_cast<int>(row) * from_width_ + static_cast<int>(column), x - column,
                  y - row};
  }
}

void GridReader::readRow(const std::vector<float>& values, int y, float* out) const {
  const Place* places = &places_[static_cast<std::size_t>(y) * to_width_];
  for (int x = 0; x < to_width_; ++x) {
    const Place& p = places[x];
    const float* at = &values[p.index];
    const float *below = at + from_width_, upper = at[0] + (at[1] - at[0]) * p.x;
    out[x] = upper + (below[0] + (below[1] - below[0]) * p.x - upper) * p.y;
  }
}

}  // namespace patina::devices::twin
