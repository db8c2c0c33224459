// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/masters.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

namespace patina::calibration {
namespace {

constexpr double kSigmas = 4;
constexpr int kFramesMin = 3;
constexpr double kFlatLow = 0.05, kFlatHigh = 0.95;

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

[[noreturn]] void refuse(const std::string& what) { throw CalibrationError(Exit::kBadData, what); }

void requireSame(const std::string& what, SizePx size, int channels, SizePx wanted,
                 int channels_wanted) {
  if (size == wanted && channels == channels_wanted) return;
  refuse(what + " is " + text(size) + " with " + std::to_string(channels) + " channels, not " +
         text(wanted) + " with " + std::to_string(channels_wanted));
}

// Texels of a master that no thread shares.
template <class Body>
void forTexels(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 15), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

// What the first pass knows of one texel's stack (Welford).
struct Stack {
  float mean = 0, squares = 0;  // sum of squared deviations
  float least = 0, most = 0;
};

class Stacker {
 public:
  explicit Stacker(std::string what) : what_(std::move(what)) {}

  Master run(const std::function<PictureSource()>& frames, Progress& progress) {
    progress.begin(what_ + ": level and noise", 0);
    eachFrame(frames(), progress, [&](const Image<float>& f) { addToStacks(f); });
    if (frames_ < kFramesMin)
      refuse(what_ + ": " + std::to_string(frames_) + " frames; at least " +
             std::to_string(kFramesMin) + " are needed");
    noise_ = pooledNoise();
    const int frames_first = std::exchange(frames_, 0);
    sum_.assign(stacks_.size(), 0);
    used_.assign(stacks_.size(), 0);
    limitsFromStacks(frames_first);
    progress.begin(what_ + ": mean without outliers", frames_first);
    eachFrame(frames(), progress, [&](const Image<float>& f) { addInliers(f); });
    if (frames_ != frames_first)
      refuse(what_ + ": " + std::to_string(frames_first) + " frames at first, " +
             std::to_string(frames_) + " when read again");
    return finish();
  }

 private:
  void eachFrame(const PictureSource& next, Progress& progress, const auto& use) {
    while (std::optional<Image<float>> frame = next()) {
      if (stacks_.empty()) {
        size_ = frame->size();
        channels_ = frame->channels();
        stacks_.resize(frame->texels().size());
      }
      requireSame(what_ + ": frame " + std::to_string(frames_), frame->size(), frame->channels(),
                  size_, channels_);
      use(*frame);
      ++frames_;
      progress.step();
    }
  }

  void addToStacks(const Image<float>& frame) {
    const float* in = frame.texels().data();
    const float share = 1.0f / static_cast<float>(frames_ + 1);
    std::atomic<bool> finite{true};
    forTexels(stacks_.size(), [&](std::size_t i) {
      Stack& s = stacks_[i];
      const float v = in[i];
      if (!std::isfinite(v)) finite = false;
      const float delta = v - s.mean;
      s.mean += delta * share;
      s.squares += delta * (v - s.mean);
      s.least = frames_ ? std::min(s.least, v) : v;
      s.most = frames_ ? std::max(s.most, v) : v;
    });
    if (!finite) refuse(what_ + ": frame " + std::to_string(frames_) + " holds no finite number");
  }

  // Standard deviation of one frame: the median over texels, which a few outliers cannot move. The
  // factor makes the median of a chi-square variable its mean (Wilson and Hilferty).
  double pooledNoise() const {
    std::vector<float> squares(stacks_.size());
    forTexels(stacks_.size(), [&](std::size_t i) { squares[i] = stacks_[i].squares; });
    auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    const double k = frames_ - 1;
    return std::sqrt(std::max(0.0f, *middle) / k / std::pow(1 - 2 / (9 * k), 3));
  }

  // A texel's own mean and noise without its extremes (an outlier would hide itself in them:
  // among n values none lies beyond (n - 1) / sqrt(n) sigma), never below the noise of all.
  void limitsFromStacks(int frames) {
    const double n = frames, widening = 1 + 2 / std::sqrt(n);  // for the extremes taken off
    forTexels(stacks_.size(), [&](std::size_t i) {
      Stack& s = stacks_[i];
      const double high = s.most - s.mean, low = s.least - s.mean;
      const double shift = -(high + low) / (n - 2);
      const double variance = (s.squares - high * high - low * low) / (n - 2) - shift * shift;
      const double sigma = std::max(noise_, widening * std::sqrt(std::max(0.0, variance)));
      s.mean = static_cast<float>(s.mean + shift);
      s.squares = static_cast<float>(kSigmas * sigma + 1e-7);  // from here on: the limit
    });
  }

  void addInliers(const Image<float>& frame) {
    const float* in = frame.texels().data();
    forTexels(stacks_.size(), [&](std::size_t i) {
      if (!(std::abs(in[i] - stacks_[i].mean) <= stacks_[i].squares)) return;
      sum_[i] += in[i];
      ++used_[i];
    });
  }

  Master finish() const {
    Master master{Image<float>(size_.width, size_.height, channels_), {}};
    master.report.frames = frames_;
    master.report.noise = noise_;
    double total = 0;
    std::int64_t rejected = 0;
    for (std::size_t i = 0; i < stacks_.size(); ++i) {
      const float v = used_[i] ? static_cast<float>(sum_[i] / used_[i]) : stacks_[i].mean;
      master.image.texels()[i] = v;
      total += v;
      rejected += frames_ - used_[i];
    }
    master.report.mean = total / static_cast<double>(stacks_.size());
    master.report.outliers_rejected = static_cast<int>(rejected);
    return master;
  }

  std::string what_;
  SizePx size_;
  int channels_ = 0, frames_ = 0;
  double noise_ = 0;
  std::vector<Stack> stacks_;
  std::vector<double> sum_;
  std::vector<int> used_;
};

// Mean of a colour over the middle quarter of the area; nothing when no sample there is of it.
std::optional<double> middleMean(ImageView<const float> image, const ColourFilters& filters,
                                 int colour) {
  const int x0 = image.width / 4, y0 = image.height / 4;
  double sum = 0, count = 0;
  for (int y = y0; y < y0 + std::max(1, image.height / 2); ++y)
    for (int x = x0; x < x0 + std::max(1, image.width / 2); ++x) {
      if (image.channels == 1 && colourAt(filters, x, y) != colour) continue;
      sum += image.at(x, y, image.channels == 1 ? 0 : colour);
      count += 1;
    }
  if (count == 0) return std::nullopt;
  return sum / count;
}

void scaleColour(ImageView<float> image, const ColourFilters& filters, int colour, double scale) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.channels > 1)
        image.at(x, y, colour) *= static_cast<float>(scale);
      else if (colourAt(filters, x, y) == colour)
        image.at(x, y) *= static_cast<float>(scale);
}

}  // namespace

Master stackDark(const std::function<PictureSource()>& frames, Progress& progress) {
  return Stacker("dark").run(frames, progress);
}

Master stackFlat(const std::function<PictureSource()>& frames, ImageView<const float> dark,
                 Progress& progress, const ColourFilters& filters) {
  Master master = Stacker("flat").run(frames, progress);
  const ImageView<float> flat = master.image.view();
  requireSame("flat: the dark", dark.size(), dark.channels, flat.size(), flat.channels);
  const int colours = flat.channels == 1 ? 3 : flat.channels;
  for (int c = 0; c < colours; ++c) {
    const std::optional<double> level = middleMean(flat, filters, c);
    if (level && !(*level >= kFlatLow && *level <= kFlatHigh))
      refuse("flat: channel " + std::to_string(c) + " lies at " +
             std::to_string(static_cast<int>(std::lround(100 * *level))) +
             " % of full scale; 5 % to 95 % are needed");
  }
  tbb::parallel_for(0, flat.height, [&](int y) {
    for (int x = 0; x < flat.width * flat.channels; ++x) flat.row(y)[x] -= dark.row(y)[x];
  });
  for (int c = 0; c < colours; ++c) {
    const std::optional<double> mean = middleMean(flat, filters, c);
    if (!mean) continue;
    if (!(*mean > 0))
      refuse("flat: channel " + std::to_string(c) + " is no brighter than the dark");
    scaleColour(flat, filters, c, 1 / *mean);
    master.report.levels[static_cast<std::size_t>(c)] = *mean;
  }
  return master;
}

}  // namespace patina::calibration
