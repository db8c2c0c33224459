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
constexpr float kFlatDead = 0.01f;  // of the mean: a texel without light, nothing to divide by
constexpr double kSecondsMax = 30 * 86400.0, kKelvinMax = 5;

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

// Mean of a channel over the middle quarter of the area.
double middleMean(ImageView<const float> image, int channel) {
  const RectPx r{image.width / 4, image.height / 4, std::max(1, image.width / 2),
                 std::max(1, image.height / 2)};
  const ImageView<const float> middle = image.crop(r);
  double sum = 0;
  for (int y = 0; y < middle.height; ++y)
    for (int x = 0; x < middle.width; ++x) sum += middle.at(x, y, channel);
  return sum / (static_cast<double>(r.width) * r.height);
}

}  // namespace

Master stackDark(const std::function<PictureSource()>& frames, Progress& progress) {
  return Stacker("dark").run(frames, progress);
}

Master stackFlat(const std::function<PictureSource()>& frames, ImageView<const float> dark,
                 Progress& progress) {
  Master master = Stacker("flat").run(frames, progress);
  const ImageView<float> flat = master.image.view();
  requireSame("flat: the dark", dark.size(), dark.channels, flat.size(), flat.channels);
  for (int c = 0; c < flat.channels; ++c) {
    const double level = middleMean(flat, c);
    if (!(level >= kFlatLow && level <= kFlatHigh))
      refuse("flat: channel " + std::to_string(c) + " lies at " +
             std::to_string(static_cast<int>(std::lround(100 * level))) +
             " % of full scale; 5 % to 95 % are needed");
  }
  tbb::parallel_for(0, flat.height, [&](int y) {
    for (int x = 0; x < flat.width * flat.channels; ++x) flat.row(y)[x] -= dark.row(y)[x];
  });
  for (int c = 0; c < flat.channels; ++c) {
    const double mean = middleMean(flat, c);
    if (!(mean > 0)) refuse("flat: channel " + std::to_string(c) + " is no brighter than the dark");
    const float scale = static_cast<float>(1 / mean);
    for (int y = 0; y < flat.height; ++y)
      for (int x = 0; x < flat.width; ++x) flat.at(x, y, c) *= scale;
  }
  return master;
}

void applyMasters(ImageView<float> frame, std::optional<ImageView<const float>> dark,
                  std::optional<ImageView<const float>> flat, const std::array<float, 3>& gain) {
  if (dark) requireSame("the dark", dark->size(), dark->channels, frame.size(), frame.channels);
  if (flat) requireSame("the flat", flat->size(), flat->channels, frame.size(), frame.channels);
  const int channels = frame.channels;
  tbb::parallel_for(tbb::blocked_range<int>(0, frame.height, 16), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) {
      float* row = frame.row(y);
      for (int i = 0; i < frame.width * channels; ++i) {
        float v = row[i];
        if (dark) v -= dark->row(y)[i];
        if (flat && flat->row(y)[i] > kFlatDead) v /= flat->row(y)[i];
        row[i] = v * gain[std::min(i % channels, 2)];
      }
    }
  });
}

CalibrationDistance distanceBetween(const CalibrationKey& frame,
                                    const CalibrationKey& calibration) {
  CalibrationDistance d;
  d.time_s = std::abs(toSeconds(frame.utc - calibration.utc));
  d.temperature_k = std::abs(frame.temperature_c - calibration.temperature_c);
  const double exposure_s = toSeconds(frame.exposure);
  const bool exposure_matters = calibration.kind == "dark";  // its charge grows with time
  if (frame.device_id != calibration.device_id)
    d.why_not = "of camera " + calibration.device_id + ", not " + frame.device_id;
  else if (frame.size != calibration.size)
    d.why_not = "of size " + text(calibration.size) + ", not " + text(frame.size);
  else if (frame.iso != calibration.iso)
    d.why_not = "at another ISO";
  else if (exposure_matters &&
           !(std::abs(toSeconds(calibration.exposure) - exposure_s) <= 0.01 * exposure_s))
    d.why_not = "exposed for " + formatExposure(calibration.exposure) + ", not " +
                formatExposure(frame.exposure);
  else if (calibration.kind == "flat" && !calibration.light_state.empty() &&
           calibration.light_state != frame.light_state)
    d.why_not = "lit by " + calibration.light_state + ", not " + frame.light_state;
  d.usable = d.why_not.empty();
  d.within_tolerance = d.usable && d.time_s <= kSecondsMax && d.temperature_k <= kKelvinMax;
  return d;
}

}  // namespace patina::calibration
