// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "processing/image/parallel_rows.h"
#include "processing/stbrdf/staf_search.h"

namespace patina::stbrdf {
namespace {

using staf::Curve;
using staf::Texel;

// [t][i] of the series chosen: learned from or fitted at once.
struct Series {
  std::size_t count = 0;
  std::vector<double> values;  // [i][t]
};

Series evenly(const TimeSamples& samples, int channel, std::size_t most) {
  const auto channels = static_cast<std::size_t>(samples.maps[0].channels());
  const std::size_t all = samples.seriesCount() / channels,
                    stride = std::max<std::size_t>(1, all / most);
  Series out;
  for (std::size_t i = stride / 2; i < all; i += stride) {
    for (const Image<float>& map : samples.maps)
      out.values.push_back(map.texels()[i * channels + static_cast<std::size_t>(channel)]);
    ++out.count;
  }
  return out;
}

class Learner {
 public:
  Learner(const Series& series, const std::vector<double>& times)
      : series_(series), times_(times), texels_(series.count) {}

  // Alternates between texels and curve; returns the sum of squared errors. `error` never rises.
  double run(Curve& curve, int rounds) {
    double error = INFINITY;
    for (Texel& texel : texels_) texel.error = INFINITY;
    for (int round = 0; round < rounds; ++round) {
      const double now = fitTexels(curve);
      if (!(now < error * (1 - 1e-4))) return std::min(now, error);
      error = now;
      const Curve next = staf::fitCurve(texels_, series_.values, times_);
      std::vector<Texel> kept = texels_;
      double after = 0;
      for (std::size_t i = 0; i < texels_.size(); ++i) {
        staf::solveLinear(next, times_, valuesOf(i), texels_[i]);
        after += texels_[i].error;
      }
      if (after <= error)
        curve = next;
      else
        texels_ = std::move(kept);
    }
    return fitTexels(curve);
  }

 private:
  const double* valuesOf(std::size_t i) const { return &series_.values[i * times_.size()]; }

  double fitTexels(const Curve& curve) {
    const staf::Grid grid(curve, times_);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, texels_.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          grid.fit(valuesOf(i), texels_[i]);
                      });
    double sum = 0;
    for (const Texel& texel : texels_) sum += texel.error;
    return sum;
  }

  const Series& series_;
  const std::vector<double>& times_;
  std::vector<Texel> texels_;
};

Curve learn(const TimeSamples& samples, int channel, const StafOptions& options) {
  const Series series = evenly(samples, channel, static_cast<std::size_t>(options.learned_from));
  constexpr int kTrialRounds = 4;
  Learner learner(series, samples.times);
  Curve best;
  double least = INFINITY;
  for (Curve start : staf::startingCurves(series.values, samples.times)) {
    const double error = learner.run(start, kTrialRounds);
    if (!(error < least)) continue;
    least = error;
    best = start;
  }
  Curve longer = best;
  if (learner.run(longer, options.rounds) <= least) best = longer;
  return best;
}

void fitChannel(const TimeSamples& samples, int channel, const Curve& curve, StafChannel& out,
                std::vector<double>& row_errors) {
  const Image<float>& first = samples.maps[0];
  const staf::Grid grid(curve, samples.times);
  for (Image<float>* map : {&out.a, &out.d, &out.rate, &out.offset})
    *map = Image<float>(first.width(), first.height(), 1);
  forEachRow(first.height(), first.width() * 10'000LL, [&](int y) {
    std::vector<double> values(samples.times.size());
    for (int x = 0; x < first.width(); ++x) {
      for (std::size_t t = 0; t < values.size(); ++t) values[t] = samples.maps[t].at(x, y, channel);
      Texel texel;
      texel.error = INFINITY;
      grid.fit(values.data(), texel);
      out.a.at(x, y) = static_cast<float>(texel.a);
      out.d.at(x, y) = static_cast<float>(texel.d);
      out.rate.at(x, y) = static_cast<float>(texel.rate);
      out.offset.at(x, y) = static_cast<float>(texel.offset);
      row_errors[static_cast<std::size_t>(y)] += texel.error;
    }
  });
  out.curve = curve.monomials();
}

}  // namespace

StafFit fitStaf(const TimeSamples& samples, const StafOptions& options, Progress& progress) {
  checkSamples(samples);
  if (samples.times.size() < 4)
    throw ProcessingError(Exit::kUsage, "a factorisation takes at least 4 times; there are " +
                                            std::to_string(samples.times.size()));
  StafFit fit;
  fit.map = {samples.name, {}, samples.low, samples.high};
  const Image<float>& first = samples.maps[0];
  progress.begin("factorising " + samples.name, first.channels());
  for (int channel = 0; channel < first.channels(); ++channel) {
    const Curve curve = learn(samples, channel, options);
    StafChannel out;
    std::vector<double> row_errors(static_cast<std::size_t>(first.height()), 0);
    fitChannel(samples, channel, curve, out, row_errors);
    double sum = 0;
    for (const double error : row_errors) sum += error;
    fit.rms.push_back(std::sqrt(sum / (static_cast<double>(first.width()) * first.height() *
                                       static_cast<double>(samples.times.size()))));
    fit.map.channels.push_back(std::move(out));
    progress.step();
  }
  return fit;
}

Image<float> evaluate(const StafMap& map, double t, Clamp clamp) {
  PATINA_CHECK(!map.channels.empty());
  const Image<float>& first = map.channels[0].a;
  const int channels = static_cast<int>(map.channels.size());
  Image<float> out(first.width(), first.height(), channels);
  forEachRow(first.height(), first.width() * 10LL * channels, [&](int y) {
    for (int x = 0; x < first.width(); ++x)
      for (int c = 0; c < channels; ++c) {
        const StafChannel& f = map.channels[static_cast<std::size_t>(c)];
        const double at = f.rate.at(x, y) * t - f.offset.at(x, y);
        double phi = 0;
        for (std::size_t k = f.curve.size(); k-- > 0;) phi = phi * at + f.curve[k];
        const auto v = static_cast<float>(f.a.at(x, y) * phi + f.d.at(x, y));
        out.at(x, y, c) = clamp == Clamp::kToRange ? std::clamp(v, map.low, map.high) : v;
      }
  });
  return out;
}

TimeMap polynomialsOf(const StafMap& map) {
  PATINA_CHECK(!map.channels.empty());
  const Image<float>& first = map.channels[0].a;
  const int channels = static_cast<int>(map.channels.size());
  TimeMap out{.name = map.name,
              .coefficients = std::vector<Image<float>>(
                  kStafDegree + 1, Image<float>(first.width(), first.height(), channels)),
              .low = map.low,
              .high = map.high};
  for (int c = 0; c < channels; ++c) {
    const StafChannel& f = map.channels[static_cast<std::size_t>(c)];
    forEachRow(first.height(), first.width() * 100LL, [&](int y) {
      for (int x = 0; x < first.width(); ++x) {
        // Horner's rule on polynomials: p <- p (R t - O) + a_k.
        double p[kStafDegree + 1] = {};
        const double r = f.rate.at(x, y), o = f.offset.at(x, y);
        for (std::size_t k = f.curve.size(); k-- > 0;) {
          for (int j = kStafDegree; j > 0; --j) p[j] = r * p[j - 1] - o * p[j];
          p[0] = f.curve[k] - o * p[0];
        }
        for (int j = 0; j <= kStafDegree; ++j)
          out.coefficients[static_cast<std::size_t>(j)].at(x, y, c) =
              static_cast<float>(f.a.at(x, y) * p[j] + (j == 0 ? f.d.at(x, y) : 0));
      }
    });
  }
  return out;
}

}  // namespace patina::stbrdf
