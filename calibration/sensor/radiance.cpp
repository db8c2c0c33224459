// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/radiance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

namespace patina::calibration {
namespace {

constexpr float kFlatDead = 0.01f;  // of the mean: a texel without light, nothing to divide by
constexpr int kPattern = 48;        // samples: whole cells of 1, 2 and 3
constexpr std::int64_t kBlockSamples = 1 << 16;  // of a row block: masters and light fit the cache

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

void requireSame(const std::string& what, SizePx size, int channels, SizePx wanted,
                 int channels_wanted) {
  if (size == wanted && channels == channels_wanted) return;
  throw CalibrationError(Exit::kBadData, what + " is " + text(size) + " with " +
                                             std::to_string(channels) + " channels, not " +
                                             text(wanted) + " with " +
                                             std::to_string(channels_wanted));
}

template <class Body>
void forRowBlocks(int height, std::int64_t row_samples, const Body& body) {
  const auto rows =
      std::max<std::int64_t>(1, kBlockSamples / std::max<std::int64_t>(1, row_samples));
  tbb::parallel_for(tbb::blocked_range<int>(0, height, static_cast<std::size_t>(rows)),
                    [&](const tbb::blocked_range<int>& range) {
                      for (int y = range.begin(); y != range.end(); ++y) body(y);
                    });
}

// Gains of a row's samples, repeated.
std::array<float, kPattern> patternOf(const SensorCorrection& correction, const ChannelGains& gain,
                                      int y, float scale) {
  std::array<float, kPattern> out{};
  for (int i = 0; i < kPattern; ++i) {
    const int colour = correction.channels == 1 ? colourAt(correction.filters, i, y)
                                                : std::min(i % correction.channels, 2);
    out[static_cast<std::size_t>(i)] = gain[static_cast<std::size_t>(colour)] * scale;
  }
  return out;
}

// light = (number - black - dark range) factor pattern. Plain loops over whole patterns: these
// vectorise. Absent masters are other loops, so that they cost no memory.
template <class Number>
struct Row {
  const Number* in;
  const float *dark, *factor;  // may be null
  const float* pattern;
  float black, range;
  float* out;

  template <bool kDark, bool kFactor>
  void chunk(int x0, int count) const {
    for (int i = 0; i < count; ++i) {
      float v = static_cast<float>(in[x0 + i]) - black;
      if constexpr (kDark) v -= dark[x0 + i] * range;
      if constexpr (kFactor) v *= factor[x0 + i];
      out[x0 + i] = v * pattern[i];
    }
  }
  template <bool kDark, bool kFactor>
  void all(int samples) const {
    int x = 0;
    for (; x + kPattern <= samples; x += kPattern) chunk<kDark, kFactor>(x, kPattern);
    chunk<kDark, kFactor>(x, samples - x);
  }
  void run(int samples) const {
    if (dark != nullptr)
      factor != nullptr ? all<true, true>(samples) : all<true, false>(samples);
    else
      factor != nullptr ? all<false, true>(samples) : all<false, false>(samples);
  }
};

// Light a code, where the curve has this light.
double stepAt(const std::array<float, kCodes>& curve, double light) {
  const auto above = std::clamp<std::ptrdiff_t>(
      std::ranges::upper_bound(curve, static_cast<float>(light)) - curve.begin(), 1, kCodes - 1);
  return curve[static_cast<std::size_t>(above)] - curve[static_cast<std::size_t>(above - 1)];
}

struct Levels {
  float black = 0, white = 1;
};

template <class Number, class AfterRow>
void pass(ImageView<const Number> in, const Levels& levels, const SensorCorrection& correction,
          const ChannelGains& gain, ImageView<float> out, const AfterRow& after_row) {
  const float range = levels.white - levels.black;
  const auto even = patternOf(correction, gain, 0, 1 / range),
             odd = patternOf(correction, gain, 1, 1 / range);
  const int samples = in.width * in.channels;
  forRowBlocks(in.height, samples, [&](int y) {
    const auto master = [&](const Image<float>& image) {
      return image.empty() ? nullptr : image.view().row(y);
    };
    const Row<Number> row{in.row(y),
                          master(correction.offset),
                          master(correction.factor),
                          (y & 1) == 0 ? even.data() : odd.data(),
                          levels.black,
                          range,
                          out.row(y)};
    row.run(samples);
    after_row(y);
  });
}

}  // namespace

SensorCorrection prepareCorrection(SizePx size, int channels, const ColourFilters& filters,
                                   std::optional<ImageView<const float>> dark,
                                   std::optional<ImageView<const float>> flat,
                                   const std::vector<Defect>& defects) {
  if (dark) requireSame("the dark", dark->size(), dark->channels, size, channels);
  if (flat) requireSame("the flat", flat->size(), flat->channels, size, channels);
  SensorCorrection out;
  out.size = size;
  out.channels = channels;
  out.filters = channels == 1 ? filters : kOneColour;
  if (dark) out.offset = copyOf(*dark);
  if (flat) {
    out.factor = copyOf(*flat);
    for (float& f : out.factor.texels()) f = f > kFlatDead ? 1 / f : 1.0f;
  }
  for (const Defect& defect : defects)
    if (defect.x < 0 || defect.y < 0 || defect.x >= size.width || defect.y >= size.height)
      throw CalibrationError(Exit::kBadData, "the defect map is of a larger picture");
  out.repairs = repairsOf(defects, size, out.filters);
  return out;
}

void toRadiance(const RawMosaic& raw, const SensorCorrection& correction, const ChannelGains& gain,
                ImageView<float> light, ImageView<std::uint8_t> marks) {
  const ImageView<const std::uint16_t> in = raw.samples.view();
  requireSame("the correction", correction.size, correction.channels, in.size(), 1);
  requireSame("the result", light.size(), light.channels, in.size(), 1);
  if (correction.filters != raw.cfa)
    throw CalibrationError(Exit::kBadData, "the correction is for other colour filters");
  if (!(raw.white_level > raw.black_level))
    throw CalibrationError(Exit::kBadData, "the raw file's white level is not above its black one");
  const bool marked = !marks.empty();
  if (marked) requireSame("the mask", marks.size(), marks.channels, in.size(), 1);
  const auto white = static_cast<std::uint16_t>(std::min(raw.white_level, 65535.0));
  pass(in, {static_cast<float>(raw.black_level), static_cast<float>(raw.white_level)}, correction,
       gain, light, [&](int y) {
         if (!marked) return;
         const std::uint16_t* numbers = in.row(y);
         std::uint8_t* to = marks.row(y);
         for (int x = 0; x < in.width; ++x) to[x] = numbers[x] >= white ? kSaturated : 0;
       });
  repair(light, correction.repairs);
  if (!marked) return;
  for (const Repair& one : correction.repairs) marks.at(one.x, one.y) |= kRepaired;
}

void correctLinear(ImageView<float> frame, const SensorCorrection& correction,
                   const ChannelGains& gain) {
  requireSame("the correction", correction.size, correction.channels, frame.size(), frame.channels);
  pass(ImageView<const float>(frame), {}, correction, gain, frame, [](int) {});
  repair(frame, correction.repairs);
}

Image<float> varianceOfLight(ImageView<const float> light, const SensorCorrection& correction,
                             const ChannelGains& gain, const NoiseModels& noise,
                             const Averaged& averaged, const ResponseCurve* response) {
  requireSame("the correction", correction.size, correction.channels, light.size(), light.channels);
  Image<float> out(light.width, light.height, light.channels);
  const auto share = [](int frames) { return frames > 0 ? 1.0 / frames : 0.0; };
  const double of_frames = share(averaged.frames), of_dark = share(averaged.dark_frames),
               of_flat = share(averaged.flat_frames);
  forRowBlocks(light.height, light.width * light.channels, [&](int y) {
    for (int i = 0; i < light.width * light.channels; ++i) {
      const auto c =
          static_cast<std::size_t>(correction.channels == 1 ? colourAt(correction.filters, i, y)
                                                            : std::min(i % correction.channels, 2));
      const NoiseModel& model = noise[c];
      // Of one picture, in numbers squared, that shows so many numbers above its dark signal.
      const auto variance = [&](double above, double dark) {
        double all = model.variance(above + dark);
        if (response) {
          const double step = stepAt(response->light[c], (above + dark) / model.range());
          all += kRoundingVariance * step * step * model.range() * model.range();
        }
        return all;
      };
      const double factor = correction.factor.empty() ? 1 : correction.factor.view().row(y)[i];
      const double unit = factor * gain[c] / model.range();  // light a number
      const double above = light.row(y)[i] / unit;
      const double dark =
          correction.offset.empty() ? 0 : correction.offset.view().row(y)[i] * model.range();
      const double flat = averaged.flat_levels[c] * model.range() / factor;  // numbers
      const double flat_share = of_flat > 0 ? of_flat * variance(flat, dark) / (flat * flat) : 0;
      out.view().row(y)[i] =
          static_cast<float>(unit * unit *
                             (of_frames * variance(above, dark) + of_dark * variance(0, dark) +
                              flat_share * above * above));
    }
  });
  return out;
}

}  // namespace patina::calibration
