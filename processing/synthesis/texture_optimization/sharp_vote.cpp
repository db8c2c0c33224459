// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/sharp_vote.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::texture_optimization {
namespace {

constexpr std::size_t kVotesMax = 49;  // of patches of 7
constexpr int kAround = 2;             // surroundings: 5 x 5 texels
constexpr std::int64_t kCostTexel = 100;

struct Shown {
  std::array<std::int32_t, kVotesMax> texels;
  std::size_t count = 0;
  bool agreed = true;
};

Shown shownAt(const patch::Votes& votes, int x, int y) {
  Shown shown;
  patch::forEachVote(votes, x, y, [&](std::int32_t texel, int, int) {
    shown.texels[shown.count++] = texel;
    shown.agreed &= texel == shown.texels[0];
  });
  return shown;
}

// The texels around (x, y), its own among them: at the edge fewer, or those of the other side.
template <class Visit>
void around(const patch::Votes& votes, int x, int y, const Visit& visit) {
  const int width = votes.target.width, height = votes.target.height;
  for (int dy = -kAround; dy <= kAround; ++dy)
    for (int dx = -kAround; dx <= kAround; ++dx) {
      int tx = x + dx, ty = y + dy;
      if (votes.wraps) {
        tx = (tx % width + width) % width;
        ty = (ty % height + height) % height;
      } else if (tx < 0 || tx >= width || ty < 0 || ty >= height) {
        continue;
      }
      visit(tx, ty);
    }
}

// `mean` less the mean around it, and the surroundings themselves.
void detailAt(const Image<float>& mean, const patch::Votes& votes, int x, int y,
              std::span<float> detail) {
  std::fill(detail.begin(), detail.end(), 0.0f);
  int count = 0;
  around(votes, x, y, [&](int tx, int ty) {
    const float* from = &mean.at(tx, ty);
    for (std::size_t c = 0; c < detail.size(); ++c) detail[c] += from[c];
    ++count;
  });
  const float share = 1.0f / static_cast<float>(count);
  const float* own = &mean.at(x, y);
  for (std::size_t c = 0; c < detail.size(); ++c) detail[c] = own[c] - detail[c] * share;
}

// Means of the votes, and the variance of the votes about them, summed over components.
Image<float> meansAndSpread(ImageView<const std::int16_t> source, int voted,
                            const patch::Votes& votes, Image<float>& spread) {
  Image<float> mean(votes.target.width, votes.target.height, voted);
  forEachRow(mean.height(), kCostTexel * mean.width(), [&](int y) {
    for (int x = 0; x < mean.width(); ++x) {
      const Shown shown = shownAt(votes, x, y);
      const std::size_t different = shown.agreed ? 1 : shown.count;
      float* to = &mean.at(x, y);
      float squares = 0, squared_mean = 0;
      for (std::size_t i = 0; i < different; ++i) {
        const std::int16_t* from =
            &source.at(shown.texels[i] % source.width, shown.texels[i] / source.width);
        for (int c = 0; c < voted; ++c) {
          const auto v = static_cast<float>(from[c]);
          to[c] += v;
          squares += v * v;
        }
      }
      const float share = 1.0f / static_cast<float>(different);
      for (int c = 0; c < voted; ++c) {
        to[c] *= share;
        squared_mean += to[c] * to[c];
      }
      spread.at(x, y) = shown.agreed ? 0 : std::max(0.0f, squares * share - squared_mean);
    }
  });
  return mean;
}

}  // namespace

VoteGain contrastLost(ImageView<const std::int16_t> source, int voted, const patch::Votes& votes) {
  const int width = votes.target.width, height = votes.target.height;
  VoteGain out{votes.target, std::vector<float>(votes.indexOf(0, height), 1.0f)};
  Image<float> spread(width, height, 1), detail(width, height, 1);
  const Image<float> mean = meansAndSpread(source, voted, votes, spread);
  forEachRow(height, kCostTexel * width, [&](int y) {
    std::vector<float> own(static_cast<std::size_t>(voted));
    for (int x = 0; x < width; ++x) {
      detailAt(mean, votes, x, y, own);
      for (const float v : own) detail.at(x, y) += v * v;
    }
  });
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x) {
      float lost = 0, left = 0;
      bool kept = false;
      around(votes, x, y, [&](int tx, int ty) {
        lost += spread.at(tx, ty);
        left += detail.at(tx, ty);
        kept |= !votes.kept.empty() && votes.kept[votes.indexOf(tx, ty)] >= 0;
      });
      if (lost > 0 && !kept)
        out.gain[votes.indexOf(x, y)] =
            std::min(kGainMost, std::sqrt(1 + lost / std::max(left, 1e-3f * lost)));
    }
  });
  return out;
}

Image<float> sharpVote(ImageView<const float> source, const patch::Votes& votes,
                       const VoteGain& gain) {
  const int width = votes.target.width, height = votes.target.height, channels = source.channels;
  Image<float> mean(width, height, channels);
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Shown shown = shownAt(votes, x, y);
      const auto at = [&](std::size_t i) {
        return &source.at(shown.texels[i] % source.width, shown.texels[i] / source.width);
      };
      float* to = &mean.at(x, y);
      if (shown.agreed) {
        std::copy_n(at(0), channels, to);
        continue;
      }
      for (std::size_t i = 0; i < shown.count; ++i) {
        const float* from = at(i);
        for (int c = 0; c < channels; ++c) to[c] += from[c];
      }
      const float share = 1.0f / static_cast<float>(shown.count);
      for (int c = 0; c < channels; ++c) to[c] *= share;
    }
  });
  if (gain.gain.empty()) return mean;
  Image<float> out = mean;
  forEachRow(height, kCostTexel * width, [&](int y) {
    std::vector<float> detail(static_cast<std::size_t>(channels));
    for (int x = 0; x < width; ++x) {
      const float more = gain.gain[votes.indexOf(x, y)] - 1;
      if (!(more > 0)) continue;
      detailAt(mean, votes, x, y, detail);
      float* to = &out.at(x, y);
      for (int c = 0; c < channels; ++c) to[c] += more * detail[static_cast<std::size_t>(c)];
    }
  });
  return out;
}

}  // namespace patina::texture_optimization
