// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/merge.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <limits>
#include <string>

#include "calibration/sensor/radiance.h"

namespace patina::calibration {
namespace {

constexpr int kRounds = 3;  // of weights from the light merged before

void check(const std::vector<Exposed>& exposures) {
  const auto refuse = [](const char* what) {
    throw CalibrationError(Exit::kBadData, std::string("merge: ") + what);
  };
  if (exposures.empty()) refuse("there is no exposure");
  for (const Exposed& one : exposures) {
    const bool same = one.light.size() == exposures[0].light.size() &&
                      one.light.channels == exposures[0].light.channels &&
                      one.marks.size() == one.light.size() &&
                      one.marks.channels == one.light.channels;
    if (!same) refuse("the exposures differ in size");
    if (!(one.exposure_s > 0)) refuse("an exposure is not positive");
  }
}

// One sample of every exposure.
class SampleMerger {
 public:
  SampleMerger(const std::vector<Exposed>& exposures, const NoiseModels& noise)
      : exposures_(exposures), noise_(noise) {}

  struct Value {
    double light = 0, error = 0;
    bool saturated = false;
    double departures = 0;  // squared, in sigmas
    int used = 0;
  };
  Value merge(int y, int i, std::size_t colour) const {
    Value out;
    double light = 0, seconds = 0, shortest = std::numeric_limits<double>::infinity();
    for (const Exposed& one : exposures_) {
      if ((one.marks.row(y)[i] & kSaturated) != 0) {
        if (one.exposure_s < shortest) out.light = one.light.row(y)[i] / one.exposure_s;
        shortest = std::min(shortest, one.exposure_s);
        continue;
      }
      light += one.light.row(y)[i];
      seconds += one.exposure_s;
      ++out.used;
    }
    if (out.used == 0) {
      out.saturated = true;
      out.error = std::numeric_limits<double>::infinity();
      return out;
    }
    out.light = light / seconds;  // the best weights where only photons make noise
    for (int round = 0; round < kRounds; ++round) weigh(y, i, noise_[colour], out);
    for (const Exposed& one : exposures_)
      if ((one.marks.row(y)[i] & kSaturated) == 0) {
        const double off = one.light.row(y)[i] - out.light * one.exposure_s;
        out.departures += off * off / variance(noise_[colour], out.light * one.exposure_s);
      }
    return out;
  }

 private:
  static double variance(const NoiseModel& noise, double share) {
    return noise.variance(share * noise.range()) / (noise.range() * noise.range());
  }
  void weigh(int y, int i, const NoiseModel& noise, Value& value) const {
    double sum = 0, weights = 0;
    for (const Exposed& one : exposures_) {
      if ((one.marks.row(y)[i] & kSaturated) != 0) continue;
      const double t = one.exposure_s, w = t * t / variance(noise, value.light * t);
      sum += w * one.light.row(y)[i] / t;
      weights += w;
    }
    value.light = sum / weights;
    value.error = 1 / std::sqrt(weights);
  }

  const std::vector<Exposed>& exposures_;
  const NoiseModels& noise_;
};

struct Sums {
  std::int64_t saturated = 0;
  double departures = 0, freedoms = 0;
};

}  // namespace

Merged mergeExposures(const std::vector<Exposed>& exposures, const ColourFilters& filters,
                      const NoiseModels& noise) {
  check(exposures);
  const ImageView<const float> first = exposures[0].light;
  Merged out;
  out.light = Image<float>(first.width, first.height, first.channels);
  out.error = out.light;
  out.marks = Image<std::uint8_t>(first.width, first.height, first.channels);
  const SampleMerger merger(exposures, noise);
  const Sums sums = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<int>(0, first.height), Sums{},
      [&](const tbb::blocked_range<int>& rows, Sums so_far) {
        for (int y = rows.begin(); y != rows.end(); ++y)
          for (int i = 0; i < first.width * first.channels; ++i) {
            const auto colour = static_cast<std::size_t>(
                first.channels == 1 ? colourAt(filters, i, y) : std::min(i % first.channels, 2));
            const SampleMerger::Value value = merger.merge(y, i, colour);
            out.light.view().row(y)[i] = static_cast<float>(value.light);
            out.error.view().row(y)[i] = static_cast<float>(value.error);
            std::uint8_t marks = value.saturated ? kSaturated : 0;
            for (const Exposed& one : exposures) marks |= one.marks.row(y)[i] & kRepaired;
            out.marks.view().row(y)[i] = marks;
            so_far.saturated += value.saturated;
            if ((marks & kRepaired) != 0 || value.used < 2) continue;
            so_far.departures += value.departures;
            so_far.freedoms += value.used - 1;
          }
        return so_far;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.saturated + b.saturated, a.departures + b.departures,
                    a.freedoms + b.freedoms};
      });
  out.saturated = sums.saturated;
  out.disagreement = sums.freedoms > 0 ? std::sqrt(sums.departures / sums.freedoms) : 0;
  return out;
}

}  // namespace patina::calibration
