// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_blend.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/displayed_rows.h"

namespace patina::quilting {
namespace {

constexpr double kReach = 3;        // in blend_px
constexpr double kResidual = 1e-3;  // of the first step's
constexpr std::array<int, 4> kStepX{1, 0, -1, 0}, kStepY{0, 1, 0, -1};

// The result's texels as a graph that may wrap around.
class Seams {
 public:
  Seams(ImageView<const float> features, const Quilt& quilt, bool wraps, const TimeWarps* warps,
        double one_sided)
      : features_(features),
        quilt_(quilt),
        source_(quilt.source_xy.view()),
        wraps_(wraps),
        warps_(warps),
        one_sided_(static_cast<float>(one_sided)) {}

  int width() const { return source_.width; }
  int height() const { return source_.height; }
  // The neighbour of (x,y) in direction d, as an index; -1: none.
  std::int64_t neighbour(int x, int y, int d) const {
    int u = x + kStepX[d], v = y + kStepY[d];
    if (wraps_) {
      u = (u + width()) % width();
      v = (v + height()) % height();
    }
    if (u < 0 || v < 0 || u >= width() || v >= height()) return -1;
    return static_cast<std::int64_t>(v) * width() + u;
  }
  // Is the neighbour's source not the source's neighbour?
  bool isCut(int x, int y, int d, std::int64_t to) const {
    return !quilt_.isWhole(x, y, static_cast<int>(to % width()), static_cast<int>(to / width()),
                           kStepX[d], kStepY[d]);
  }
  // Adds J(p,q): by how much q departs from what p's source goes on with, p the upper or left one
  // (or, where that ends, p from what lies before q's), and the mean of both, by their shares.
  void addJump(int x, int y, int d, std::int64_t to, float* out) const {
    const std::int32_t *p = source_.data + 2 * (static_cast<std::int64_t>(y) * width() + x),
                       *q = source_.data + 2 * to;
    const bool on = isSource(p[0] + kStepX[d], p[1] + kStepY[d]);
    const bool back = isSource(q[0] - kStepX[d], q[1] - kStepY[d]);
    const int by_p = quilt_.block.at(x, y), by_q = quilt_.block.at(static_cast<int>(to % width()),
                                                                   static_cast<int>(to / width()));
    std::vector<float> room(warps_ ? 4 * static_cast<std::size_t>(channels()) : 0);
    const float* fp = shown(by_p, p[0], p[1], 0, room);
    const float* fq = shown(by_q, q[0], q[1], 1, room);
    const float* p_on = on ? shown(by_p, p[0] + kStepX[d], p[1] + kStepY[d], 2, room) : fp;
    const float* q_back = back ? shown(by_q, q[0] - kStepX[d], q[1] - kStepY[d], 3, room) : fq;
    const bool is_first = d < 2;  // p, seen from here
    const bool by_own = is_first ? on : on && !back;
    for (int k = 0; k < features_.channels; ++k)
      out[k] += one_sided_ * (by_own ? fq[k] - p_on[k] : q_back[k] - fp[k]) +
                (1 - one_sided_) * 0.5f * ((fq[k] - p_on[k]) + (q_back[k] - fp[k]));
  }
  int channels() const { return features_.channels; }

 private:
  // Features of a source texel as a block shows them; `room` has a place for each of four.
  const float* shown(int block, int x, int y, std::size_t place, std::vector<float>& room) const {
    const float* features = &features_.at(x, y);
    if (!warps_) return features;
    float* out = room.data() + place * static_cast<std::size_t>(channels());
    warps_->warp(block, features, out);
    return out;
  }
  bool isSource(int x, int y) const {
    return x >= 0 && y >= 0 && x < features_.width && y < features_.height;
  }

  ImageView<const float> features_;
  const Quilt& quilt_;
  ImageView<const std::int32_t> source_;
  bool wraps_;
  const TimeWarps* warps_;
  float one_sided_;
};

// 1 where a seam lies within `reach` texels along both axes.
std::vector<std::uint8_t> nearSeams(const Seams& seams, int reach, bool wraps) {
  const int w = seams.width(), h = seams.height();
  std::vector<std::uint8_t> on(static_cast<std::size_t>(w) * h);
  tbb::parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x)
      for (int d = 0; d < 4; ++d) {
        const std::int64_t to = seams.neighbour(x, y, d);
        if (to >= 0 && seams.isCut(x, y, d, to)) on[static_cast<std::size_t>(y) * w + x] = 1;
      }
  });
  const auto grow = [&](int lines, int length, std::ptrdiff_t line_step, std::ptrdiff_t step) {
    tbb::parallel_for(0, lines, [&](int line) {
      std::uint8_t* first = on.data() + line * line_step;
      std::vector<int> sum(length + 1);
      for (int i = 0; i < length; ++i) sum[i + 1] = sum[i] + first[i * step];
      const auto within = [&](int from, int to) {
        return sum[std::min(to, length)] - sum[std::max(from, 0)] > 0;
      };
      for (int i = 0; i < length; ++i) {
        bool is = within(i - reach, i + reach + 1);
        if (wraps) {
          is = is || (i < reach && within(length + i - reach, length));
          is = is || (i + reach >= length && within(0, i + reach + 1 - length));
        }
        first[i * step] = is;
      }
    });
  };
  grow(h, w, w, 1);
  grow(w, h, 1, w);
  return on;
}

// Chebyshev's acceleration of Jacobi's method (Golub and Varga 1961): no texel waits for another in
// the same pass, so the order of threads cannot be seen.
class Relaxation {
 public:
  Relaxation(const Seams& seams, double blend_px, bool wraps)
      : seams_(seams),
        lambda_(1 / (blend_px * blend_px)),
        near_(nearSeams(seams, static_cast<int>(std::ceil(kReach * blend_px)), wraps)),
        jumps_(seams.width(), seams.height(), seams.channels()),
        now_(seams.width(), seams.height(), seams.channels()),
        before_(seams.width(), seams.height(), seams.channels()) {
    tbb::parallel_for(0, seams.height(), [&](int y) {
      for (int x = 0; x < seams.width(); ++x)
        for (int d = 0; d < 4; ++d) {
          const std::int64_t to = seams.neighbour(x, y, d);
          if (to >= 0 && seams.isCut(x, y, d, to)) seams.addJump(x, y, d, to, &jumps_.at(x, y));
        }
    });
  }

  Image<float> solve(Progress& progress) {
    const double rho = 4 / (4 + lambda_), root = std::sqrt(1 - rho * rho);
    const int passes =
        static_cast<int>(std::ceil(std::log(kResidual) / std::log(std::sqrt(2 / (1 + root) - 1))));
    progress.begin("blending", passes);
    double omega = 1;
    for (int i = 0; i < passes; ++i) {
      omega = i == 0 ? 1 : i == 1 ? 1 / (1 - rho * rho / 2) : 1 / (1 - rho * rho * omega / 4);
      pass(static_cast<float>(omega));
      std::swap(now_, before_);
      progress.step();
    }
    return std::move(now_);
  }

 private:
  // before_ = omega * (Jacobi of now_ - before_) + before_
  void pass(float omega) {
    const int channels = seams_.channels(), w = seams_.width();
    const std::vector<float> nothing(channels);
    tbb::parallel_for(0, seams_.height(), [&](int y) {
      for (int x = 0; x < w; ++x) {
        if (!near_[static_cast<std::size_t>(y) * w + x]) continue;
        double neighbours = 0;
        std::array<const float*, 4> from;
        for (int d = 0; d < 4; ++d) {
          const std::int64_t to = seams_.neighbour(x, y, d);
          from[d] = to < 0 ? nothing.data() : now_.texels().data() + to * channels;
          neighbours += to >= 0;
        }
        relax(from, &jumps_.at(x, y), static_cast<float>(1 / (neighbours + lambda_)), omega,
              &before_.at(x, y), channels);
      }
    });
  }

  static void relax(const std::array<const float*, 4>& from, const float* jump, float share,
                    float omega, float* out, int channels) {
    const float *a = from[0], *b = from[1], *c = from[2], *d = from[3];
    for (int k = 0; k < channels; ++k)
      out[k] += omega * ((jump[k] + (a[k] + b[k]) + (c[k] + d[k])) * share - out[k]);
  }

  const Seams& seams_;
  double lambda_;
  std::vector<std::uint8_t> near_;
  Image<float> jumps_, now_, before_;
};

}  // namespace

Image<float> seamCorrection(ImageView<const float> features, const Quilt& quilt, double blend_px,
                            bool wraps, Progress& progress, const TimeWarps* warps,
                            double one_sided) {
  PATINA_CHECK(one_sided >= 0 && one_sided <= 1);
  const Seams seams(features, quilt, wraps, warps, one_sided);
  return Relaxation(seams, blend_px, wraps).solve(progress);
}

SeamBlend::SeamBlend(const Image<float>& correction, const TtfFeatures& features, double scale)
    : rank_(correction.channels()),
      planes_(correction.width(), correction.height() * rank_, 1),
      features_(features),
      display_(displayTable(scale)),
      sample_(65536) {
  tbb::parallel_for(0, correction.height(), [&](int y) {
    for (int x = 0; x < correction.width(); ++x)
      for (int k = 0; k < rank_; ++k) planes_.at(x, y * rank_ + k) = correction.at(x, y, k);
  });
  for (int i = 0; i < 65536; ++i)
    sample_[i] = static_cast<std::uint16_t>(
        std::min(65535.0, std::round(65535.0 / scale * linearFromSrgb(i / 65535.0f))));
}

std::uint16_t SeamBlend::moved(std::uint16_t sample, float by) const {
  const float display = std::clamp(display_[sample] + by, 0.0f, 1.0f);
  return sample_[static_cast<std::size_t>(std::lround(display * 65535))];
}
float SeamBlend::moved(float sample, float by) const {
  if (!(sample >= 0 && sample <= 1)) return sample;  // beyond what is displayed
  return linearFromSrgb(srgbFromLinear(sample) + by);
}

template <class T>
void SeamBlend::add(int t, ImageView<T> frame) const {
  const float* basis = features_.basis.data() + std::ptrdiff_t{t} * frame.channels * rank_;
  tbb::parallel_for(0, frame.height, [&](int y) {
    std::vector<float> by(frame.width);
    for (int channel = 0; channel < frame.channels; ++channel) {
      std::fill(by.begin(), by.end(), 0.0f);
      for (int k = 0; k < rank_; ++k) {
        const float* plane = planes_.view().row(y * rank_ + k);
        const float share = basis[channel * rank_ + k] / features_.weight[t];
        for (int x = 0; x < frame.width; ++x) by[x] += share * plane[x];
      }
      for (int x = 0; x < frame.width; ++x)
        if (by[x] != 0) frame.at(x, y, channel) = moved(frame.at(x, y, channel), by[x]);
    }
  });
}

void SeamBlend::apply(int t, ImageView<std::uint16_t> frame) const { add(t, frame); }
void SeamBlend::apply(int t, ImageView<float> frame) const { add(t, frame); }

}  // namespace patina::quilting
