// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/sharp_vote.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::texture_optimization {
namespace {

constexpr std::size_t kVotesMax = 49;  // of patches of 7
constexpr int kAround = 2;             // surroundings: 5 x 5 texels
constexpr int kBandRows = 24;

int wrapped(int i, int length) { return (i % length + length) % length; }

// Means of the votes over rows [first, last) of the target and kAround more on both sides.
class Band {
 public:
  Band(ImageView<const float> source, const patch::Votes& votes, int first, int last)
      : source_(source),
        votes_(votes),
        first_(first - kAround),
        channels_(static_cast<std::size_t>(source.channels)),
        means_(static_cast<std::size_t>(last - first + 2 * kAround) * rowLength()),
        above_(rowLength()) {
    for (int y = first_; y < last + kAround; ++y)
      if (isThere(y))
        for (int x = 0; x < votes.target.width; ++x) voteTexel(x, y);
  }

  std::span<const float> row(int y) const { return {mean(0, y), rowLength()}; }

  // Prepares detail() for row y.
  void turnTo(int y) {
    std::fill(above_.begin(), above_.end(), 0.0f);
    rows_ = 0;
    for (int i = y - kAround; i <= y + kAround; ++i) {
      if (!isThere(i)) continue;
      const float* from = mean(0, i);
      for (std::size_t k = 0; k < above_.size(); ++k) above_[k] += from[k];
      ++rows_;
    }
  }
  // The mean at (x, y) less the mean of its surroundings.
  void detail(int x, int y, std::span<float> out) const {
    std::fill(out.begin(), out.end(), 0.0f);
    const int width = votes_.target.width;
    int columns = 0;
    for (int i = x - kAround; i <= x + kAround; ++i) {
      if (!votes_.wraps && (i < 0 || i >= width)) continue;
      const float* from = &above_[static_cast<std::size_t>(wrapped(i, width)) * channels_];
      for (std::size_t c = 0; c < channels_; ++c) out[c] += from[c];
      ++columns;
    }
    const float share = 1.0f / static_cast<float>(rows_ * columns);
    const float* own = mean(x, y);
    for (std::size_t c = 0; c < channels_; ++c) out[c] = own[c] - out[c] * share;
  }
  // Variance of the votes about their mean, summed over channels.
  float spread(int x, int y) const {
    const Shown shown = shownAt(x, wrapped(y, votes_.target.height));
    if (shown.agreed) return 0;
    const float* about = mean(x, y);
    float squares = 0;
    for (std::size_t i = 0; i < shown.count; ++i) {
      const float* from = texel(shown.texels[i]);
      for (std::size_t c = 0; c < channels_; ++c)
        squares += (from[c] - about[c]) * (from[c] - about[c]);
    }
    return squares / static_cast<float>(shown.count);
  }

 private:
  struct Shown {
    std::array<std::int32_t, kVotesMax> texels;
    std::size_t count = 0;
    bool agreed = true;
  };

  std::size_t rowLength() const {
    return static_cast<std::size_t>(votes_.target.width) * channels_;
  }
  bool isThere(int y) const { return votes_.wraps || (y >= 0 && y < votes_.target.height); }
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y - first_) * rowLength() +
           static_cast<std::size_t>(x) * channels_;
  }
  const float* mean(int x, int y) const { return &means_[indexOf(x, y)]; }
  const float* texel(std::int32_t index) const {
    return &source_.at(index % source_.width, index / source_.width);
  }
  Shown shownAt(int x, int y) const {
    Shown shown;
    patch::forEachVote(votes_, x, y, [&](std::int32_t texel, int, int) {
      shown.texels[shown.count++] = texel;
      shown.agreed &= texel == shown.texels[0];
    });
    return shown;
  }
  void voteTexel(int x, int y) {
    const Shown shown = shownAt(x, wrapped(y, votes_.target.height));
    float* to = &means_[indexOf(x, y)];
    if (shown.agreed) {
      std::copy_n(texel(shown.texels[0]), channels_, to);
      return;
    }
    for (std::size_t i = 0; i < shown.count; ++i) {
      const float* from = texel(shown.texels[i]);
      for (std::size_t c = 0; c < channels_; ++c) to[c] += from[c];
    }
    const float share = 1.0f / static_cast<float>(shown.count);
    for (std::size_t c = 0; c < channels_; ++c) to[c] *= share;
  }

  ImageView<const float> source_;
  const patch::Votes& votes_;
  int first_, rows_ = 0;
  std::size_t channels_;
  std::vector<float> means_, above_;
};

template <class Body>
void forEachBand(int height, const Body& body) {
  tbb::parallel_for(0, (height + kBandRows - 1) / kBandRows, [&](int band) {
    body(band * kBandRows, std::min(height, (band + 1) * kBandRows));
  });
}

Image<float> firstComponents(ImageView<const std::int16_t> source, int count) {
  Image<float> out(source.width, source.height, count);
  forEachRow(out.height(), std::int64_t{out.width()} * count, [&](int y) {
    for (int x = 0; x < out.width(); ++x) std::copy_n(&source.at(x, y), count, &out.at(x, y));
  });
  return out;
}

// Sums over the surroundings of each texel, [h][w][c] with few channels.
template <class Visit>
void around(const patch::Votes& votes, int x, int y, const Visit& visit) {
  const int width = votes.target.width, height = votes.target.height;
  for (int ty = y - kAround; ty <= y + kAround; ++ty)
    for (int tx = x - kAround; tx <= x + kAround; ++tx) {
      if (!votes.wraps && (tx < 0 || tx >= width || ty < 0 || ty >= height)) continue;
      visit(wrapped(tx, width), wrapped(ty, height));
    }
}

}  // namespace

VoteGain contrastLost(ImageView<const std::int16_t> source, int voted, const patch::Votes& votes) {
  const int width = votes.target.width, height = votes.target.height;
  VoteGain out{votes.target, std::vector<float>(votes.indexOf(0, height), 1.0f)};
  Image<float> lost_left(width, height, 2);
  const Image<float> components = firstComponents(source, voted);
  forEachBand(height, [&](int first, int last) {
    Band band(components.view(), votes, first, last);
    std::vector<float> own(static_cast<std::size_t>(voted));
    for (int y = first; y < last; ++y) {
      band.turnTo(y);
      for (int x = 0; x < width; ++x) {
        lost_left.at(x, y, 0) = band.spread(x, y);
        band.detail(x, y, own);
        for (const float v : own) lost_left.at(x, y, 1) += v * v;
      }
    }
  });
  constexpr std::int64_t kCostTexel = 60;
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x) {
      float lost = 0, left = 0;
      bool kept = false;
      around(votes, x, y, [&](int tx, int ty) {
        lost += lost_left.at(tx, ty, 0);
        left += lost_left.at(tx, ty, 1);
        kept |= !votes.kept.empty() && votes.kept[votes.indexOf(tx, ty)] >= 0;
      });
      if (lost > 0 && !kept)
        out.gain[votes.indexOf(x, y)] =
            std::min(kGainMost, std::sqrt(1 + lost / std::max(left, 1e-3f * lost)));
    }
  });
  return out;
}

void sharpVote(ImageView<const float> source, const patch::Votes& votes, const VoteGain& gain,
               const TakeRow& take) {
  const auto channels = static_cast<std::size_t>(source.channels);
  forEachBand(votes.target.height, [&](int first, int last) {
    Band band(source, votes, first, last);
    std::vector<float> row, detail(channels);
    for (int y = first; y < last; ++y) {
      if (gain.gain.empty()) {
        take(y, band.row(y));
        continue;
      }
      row.assign(band.row(y).begin(), band.row(y).end());
      band.turnTo(y);
      for (int x = 0; x < votes.target.width; ++x) {
        const float more = gain.gain[votes.indexOf(x, y)] - 1;
        if (!(more > 0)) continue;
        band.detail(x, y, detail);
        float* to = &row[static_cast<std::size_t>(x) * channels];
        for (std::size_t c = 0; c < channels; ++c) to[c] += more * detail[c];
      }
      take(y, row);
    }
  });
}

Image<float> sharpVote(ImageView<const float> source, const patch::Votes& votes,
                       const VoteGain& gain) {
  Image<float> out(votes.target.width, votes.target.height, source.channels);
  sharpVote(source, votes, gain, [&](int y, std::span<const float> row) {
    std::copy(row.begin(), row.end(), out.view().row(y));
  });
  return out;
}

}  // namespace patina::texture_optimization
