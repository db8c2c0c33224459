// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/lamp_gains.h"

#include <algorithm>
#include <cmath>

#include "calibration/lamps/median.h"
#include "calibration/lamps/normal_equations.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr double kLikenessMost = 0.9999, kGainSigmaMost = 0.2;
constexpr double kHuber = 1.345;  // sigmas; 95 % as good as least squares on clean samples

[[noreturn]] void refuseAlike() {
  throw CalibrationError(Exit::kBadData,
                         "these patches cannot tell the lamps apart; shoot each lamp alone in the "
                         "sweep, or watch patches that they light differently");
}

double sigmaOf(const GainSample& sample) { return sample.sigma > 0 ? sample.sigma : 1; }

double residualOf(const GainSample& sample, const std::vector<double>& gain) {
  double off = sample.now;
  for (std::size_t lamp = 0; lamp < gain.size(); ++lamp) off -= gain[lamp] * sample.then[lamp];
  return off;
}

// Greatest cosine between what two lamps give the samples.
double likenessOf(const std::vector<GainSample>& samples, std::size_t lamps) {
  const auto product = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (const GainSample& sample : samples) sum += sample.then[a] * sample.then[b];
    return sum;
  };
  for (const GainSample& sample : samples) {
    PATINA_CHECK(sample.then.size() == lamps);
    for (const double level : sample.then)
      if (!std::isfinite(level) || !std::isfinite(sample.now))
        throw CalibrationError(Exit::kBadData, "a level of a patch is no number");
  }
  double likeness = 0;
  for (std::size_t a = 0; a < lamps; ++a) {
    if (!(product(a, a) > 0))
      throw CalibrationError(Exit::kBadData, "a lamp gave no light when its baseline was taken");
    for (std::size_t b = 0; b < a; ++b)
      likeness = std::max(likeness, product(a, b) / std::sqrt(product(a, a) * product(b, b)));
  }
  return likeness;
}

}  // namespace

LampGains solveLampGains(const std::vector<GainSample>& samples) {
  const std::size_t lamps = samples.empty() ? 0 : samples.front().then.size();
  if (lamps < 1 || samples.size() < lamps)
    throw CalibrationError(Exit::kBadData, "gains need as many samples as there are lamps");
  LampGains out;
  out.likeness = likenessOf(samples, lamps);
  if (out.likeness > kLikenessMost) refuseAlike();

  std::vector<double> weight(samples.size(), 1), off(samples.size());
  std::vector<double> covariance;
  for (int round = 0; round < 8; ++round) {
    NormalEquations equations(static_cast<int>(lamps));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double sigma = sigmaOf(samples[i]);
      equations.add(samples[i].then, samples[i].now, weight[i] / (sigma * sigma));
    }
    out.gain = equations.solved();
    covariance = equations.covariance();
    for (std::size_t i = 0; i < samples.size(); ++i)
      off[i] = std::abs(residualOf(samples[i], out.gain)) / sigmaOf(samples[i]);
    const double limit = kHuber * std::max(1.4826 * medianOf(off), 1e-12);
    for (std::size_t i = 0; i < samples.size(); ++i)
      weight[i] = std::min(1.0, limit / std::max(off[i], 1e-300));
  }
  double square = 0, relative = 0, mean = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    square += weight[i] * off[i] * off[i];
    relative += std::pow(residualOf(samples[i], out.gain), 2) / static_cast<double>(samples.size());
    mean += std::abs(samples[i].now) / static_cast<double>(samples.size());
  }
  out.residual_rms = std::sqrt(relative) / std::max(mean, 1e-300);
  // Of the residuals where there are more samples than lamps, else as the samples say.
  const bool spare = samples.size() > lamps;
  const double scale2 = spare ? square / static_cast<double>(samples.size() - lamps) : 1;
  for (std::size_t lamp = 0; lamp < lamps; ++lamp) {
    const double variance = std::max(covariance[lamp * lamps + lamp], 0.0) * scale2;
    out.sigma.push_back(spare || samples.front().sigma > 0 ? std::sqrt(variance) : 0);
    if (!(out.sigma.back() <= kGainSigmaMost) || !std::isfinite(out.gain[lamp])) refuseAlike();
  }
  return out;
}

void undoDriftByFields(ImageView<float> frame, std::span<const ImageView<const float>> fields,
                       std::span<const ChannelGains> gains) {
  PATINA_CHECK(fields.size() == gains.size() && !fields.empty());
  for (const ImageView<const float>& field : fields)
    if (field.size() != frame.size() || field.channels != frame.channels)
      throw CalibrationError(Exit::kBadData, "a lamp's field is of another size than the frame");
  forEachRow(frame.height, std::int64_t{frame.width} * frame.channels, [&](int y) {
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < frame.channels; ++c) {
        float then = 0, now = 0;
        for (std::size_t lamp = 0; lamp < fields.size(); ++lamp) {
          const float light = fields[lamp].at(x, y, c);
          then += light;
          now += gains[lamp][c] * light;
        }
        if (now > 0) frame.at(x, y, c) *= then / now;
      }
  });
}

void undoDriftByShots(ImageView<float> frame, std::span<const ImageView<const float>> shots,
                      std::span<const ChannelGains> gains) {
  PATINA_CHECK(shots.size() == gains.size() && !shots.empty());
  for (std::size_t lamp = 0; lamp < shots.size(); ++lamp) {
    if (shots[lamp].size() != frame.size() || shots[lamp].channels != frame.channels)
      throw CalibrationError(Exit::kBadData, "a lamp's shot is of another size than the frame");
    for (int c = 0; c < frame.channels; ++c)
      if (!(gains[lamp][c] > 0))
        throw CalibrationError(Exit::kBadData, "a lamp that gives no light has no gain");
  }
  forEachRow(frame.height, std::int64_t{frame.width} * frame.channels, [&](int y) {
    for (std::size_t lamp = 0; lamp < shots.size(); ++lamp)
      for (int x = 0; x < frame.width; ++x)
        for (int c = 0; c < frame.channels; ++c)
          frame.at(x, y, c) -= (1 - 1 / gains[lamp][c]) * shots[lamp].at(x, y, c);
  });
}

}  // namespace patina::calibration
