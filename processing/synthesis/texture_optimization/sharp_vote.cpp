// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/sharp_vote.h"

#include <immintrin.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::texture_optimization {
namespace {

constexpr std::size_t kVotesMax = 49;  // of patches of 7
constexpr int kAround = 2;             // surroundings: 5 x 5 texels
constexpr int kBandRows = 48;

int wrapped(int i, int length) { return (i % length + length) % length; }

// Texels of a multiple of four numbers, zeros behind: whole registers are added.
template <class T>
Image<float> padded(ImageView<const T> source, int count) {
  Image<float> out(source.width, source.height, (count + 3) / 4 * 4);
  forEachRow(out.height(), std::int64_t{out.width()} * count, [&](int y) {
    for (int x = 0; x < out.width(); ++x) std::copy_n(&source.at(x, y), count, &out.at(x, y));
  });
  return out;
}

// Each texel less the mean of its surroundings.
Image<float> detailOf(const Image<float>& image) {
  const int width = image.width(), height = image.height(), channels = image.channels();
  Image<float> out(width, height, channels);
  forEachRow(height, std::int64_t{width} * channels * 8, [&](int y) {
    const int top = std::max(y - kAround, 0), bottom = std::min(y + kAround, height - 1);
    std::vector<float> above(static_cast<std::size_t>(width * channels), 0.0f);
    for (int i = top; i <= bottom; ++i) {
      const float* from = &image.at(0, i);
      for (std::size_t k = 0; k < above.size(); ++k) above[k] += from[k];
    }
    for (int x = 0; x < width; ++x) {
      const int left = std::max(x - kAround, 0), right = std::min(x + kAround, width - 1);
      const float share = 1.0f / static_cast<float>((bottom - top + 1) * (right - left + 1));
      for (int c = 0; c < channels; ++c) {
        float sum = 0;
        for (int i = left * channels + c; i <= right * channels + c; i += channels)
          sum += above[static_cast<std::size_t>(i)];
        out.at(x, y, c) = image.at(x, y, c) - share * sum;
      }
    }
  });
  return out;
}

// Means of the votes over rows [first, last) of the target and kAround more on both sides.
class Band {
 public:
  // `source`: as padded() gives it. `details`: of the source, or null: no spread is asked for.
  Band(const Image<float>& source, const patch::Votes& votes, int first, int last,
       const Image<float>* details)
      : source_(source),
        details_(details),
        votes_(votes),
        first_(first - kAround),
        channels_(static_cast<std::size_t>(source.channels())),
        means_(static_cast<std::size_t>(last - first + 2 * kAround) * rowLength()),
        above_(rowLength()) {
    if (details != nullptr) spreads_.resize(means_.size() / channels_);
    for (int y = first_; y < last + kAround; ++y)
      if (isThere(y))
        for (int x = 0; x < votes.target.width; ++x) voteTexel(x, y);
  }

  const float* mean(int x, int y) const { return &means_[texelOf(x, y) * channels_]; }
  // Variance of the votes' details about their mean, summed over channels.
  float spread(int x, int y) const { return spreads_[texelOf(x, y)]; }

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
  void detail(int x, int y, float* out) const {
    const int width = votes_.target.width,
              left = votes_.wraps ? x - kAround : std::max(x - kAround, 0),
              right = votes_.wraps ? x + kAround : std::min(x + kAround, width - 1);
    const __m128 share = _mm_set1_ps(1.0f / static_cast<float>(rows_ * (right - left + 1)));
    const float* own = mean(x, y);
    const bool inside = left >= 0 && right < width;
    for (std::size_t c = 0; c < channels_; c += 4) {
      __m128 sum = _mm_setzero_ps();
      for (int i = left; i <= right; ++i) {
        const auto at = static_cast<std::size_t>(inside ? i : wrapped(i, width));
        sum = _mm_add_ps(sum, _mm_loadu_ps(&above_[at * channels_ + c]));
      }
      _mm_storeu_ps(out + c, _mm_sub_ps(_mm_loadu_ps(own + c), _mm_mul_ps(sum, share)));
    }
  }

 private:
  std::size_t rowLength() const {
    return static_cast<std::size_t>(votes_.target.width) * channels_;
  }
  bool isThere(int y) const { return votes_.wraps || (y >= 0 && y < votes_.target.height); }
  std::size_t texelOf(int x, int y) const {
    return static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(votes_.target.width) +
           static_cast<std::size_t>(x);
  }
  void voteTexel(int x, int y) {
    std::array<std::size_t, kVotesMax> shown{};  // where their numbers begin
    std::size_t count = 0;
    bool agreed = true;
    patch::forEachVote(votes_, x, wrapped(y, votes_.target.height),
                       [&](std::int32_t texel, int, int) {
                         shown[count] = static_cast<std::size_t>(texel) * channels_;
                         agreed &= shown[count++] == shown[0];
                       });
    float* to = &means_[texelOf(x, y) * channels_];
    const float* from = source_.texels().data();
    if (agreed) {
      std::copy_n(from + shown[0], channels_, to);
      return;
    }
    const __m128 share = _mm_set1_ps(1.0f / static_cast<float>(count));
    for (std::size_t c = 0; c < channels_; c += 4) {
      __m128 sum = _mm_setzero_ps();
      for (std::size_t i = 0; i < count; ++i)
        sum = _mm_add_ps(sum, _mm_loadu_ps(from + shown[i] + c));
      _mm_storeu_ps(to + c, _mm_mul_ps(sum, share));
    }
    if (details_ != nullptr) spreads_[texelOf(x, y)] = spreadOf(std::span(shown).first(count));
  }
  float spreadOf(std::span<const std::size_t> shown) const {
    const float* from = details_->texels().data();
    const __m128 share = _mm_set1_ps(1.0f / static_cast<float>(shown.size()));
    __m128 squares = _mm_setzero_ps();
    for (std::size_t c = 0; c < channels_; c += 4) {
      __m128 sum = _mm_setzero_ps(), own = sum;
      for (const std::size_t at : shown) {
        const __m128 v = _mm_loadu_ps(from + at + c);
        sum = _mm_add_ps(sum, v);
        own = _mm_add_ps(own, _mm_mul_ps(v, v));
      }
      const __m128 mean = _mm_mul_ps(sum, share);
      squares = _mm_add_ps(squares, _mm_sub_ps(_mm_mul_ps(own, share), _mm_mul_ps(mean, mean)));
    }
    alignas(16) std::array<float, 4> parts;
    _mm_store_ps(parts.data(), squares);
    return std::max(0.0f, parts[0] + parts[1] + (parts[2] + parts[3]));
  }

  const Image<float>& source_;
  const Image<float>* details_;
  const patch::Votes& votes_;
  int first_, rows_ = 0;
  std::size_t channels_;
  std::vector<float> means_, spreads_, above_;
};

template <class Body>
void forEachBand(int height, const Body& body) {
  tbb::parallel_for(0, (height + kBandRows - 1) / kBandRows, [&](int band) {
    body(band * kBandRows, std::min(height, (band + 1) * kBandRows));
  });
}

// Sums over the surroundings of each texel, [h][w][4].
Image<float> aroundEach(const patch::Votes& votes, const Image<float>& in) {
  const int width = in.width(), height = in.height();
  Image<float> across(width, height, 4), out(width, height, 4);
  constexpr std::int64_t kCostTexel = 8;
  const auto sum = [&](int i, int length, const auto& at) {
    __m128 all = _mm_setzero_ps();
    for (int k = i - kAround; k <= i + kAround; ++k) {
      if (k >= 0 && k < length)
        all = _mm_add_ps(all, _mm_loadu_ps(at(k)));
      else if (votes.wraps)
        all = _mm_add_ps(all, _mm_loadu_ps(at(wrapped(k, length))));
    }
    return all;
  };
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x)
      _mm_storeu_ps(&across.at(x, y), sum(x, width, [&](int i) { return &in.at(i, y); }));
  });
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x)
      _mm_storeu_ps(&out.at(x, y), sum(y, height, [&](int i) { return &across.at(x, i); }));
  });
  return out;
}

}  // namespace

VoteGain contrastLost(ImageView<const std::int16_t> source, int voted, const patch::Votes& votes) {
  const int width = votes.target.width, height = votes.target.height;
  VoteGain out{votes.target, std::vector<float>(votes.indexOf(0, height), 1.0f)};
  enum { kLost, kLeft, kKept, kNumbers = 4 };
  Image<float> numbers(width, height, kNumbers);
  const Image<float> components = padded(source, voted), details = detailOf(components);
  forEachBand(height, [&](int first, int last) {
    Band band(components, votes, first, last, &details);
    std::vector<float> detail(static_cast<std::size_t>(components.channels()));
    for (int y = first; y < last; ++y) {
      band.turnTo(y);
      for (int x = 0; x < width; ++x) {
        numbers.at(x, y, kLost) = band.spread(x, y);
        band.detail(x, y, detail.data());
        for (const float v : detail) numbers.at(x, y, kLeft) += v * v;
        numbers.at(x, y, kKept) = !votes.kept.empty() && votes.kept[votes.indexOf(x, y)] >= 0;
      }
    }
  });
  const Image<float> around = aroundEach(votes, numbers);
  constexpr std::int64_t kCostTexel = 8;
  forEachRow(height, kCostTexel * width, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const float lost = around.at(x, y, kLost), left = around.at(x, y, kLeft);
      if (lost > 0 && around.at(x, y, kKept) == 0)
        out.gain[votes.indexOf(x, y)] =
            std::min(kGainMost, std::sqrt(1 + lost / std::max(left, 1e-3f * lost)));
    }
  });
  return out;
}

void sharpVote(ImageView<const float> source, const patch::Votes& votes, const VoteGain& gain,
               const TakeRow& take) {
  const auto channels = static_cast<std::size_t>(source.channels);
  const auto width = static_cast<std::size_t>(votes.target.width);
  const Image<float> texels = padded(source, source.channels);
  forEachBand(votes.target.height, [&](int first, int last) {
    Band band(texels, votes, first, last, nullptr);
    std::vector<float> row(width * channels), detail(static_cast<std::size_t>(texels.channels()));
    for (int y = first; y < last; ++y) {
      if (!gain.gain.empty()) band.turnTo(y);
      for (int x = 0; x < votes.target.width; ++x) {
        float* to = &row[static_cast<std::size_t>(x) * channels];
        std::copy_n(band.mean(x, y), channels, to);
        const float more = gain.gain.empty() ? 0 : gain.gain[votes.indexOf(x, y)] - 1;
        if (!(more > 0)) continue;
        band.detail(x, y, detail.data());
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
