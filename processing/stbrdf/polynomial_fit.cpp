// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/polynomial_fit.h"

#include <cmath>

#include "processing/stbrdf/bounded_fit.h"
#include "processing/stbrdf/projection.h"

namespace patina::stbrdf {
namespace {

std::vector<double> rmsOf(const Image<float>& error) {
  const auto channels = static_cast<std::size_t>(error.channels());
  std::vector<double> sums(channels, 0);
  for (int y = 0; y < error.height(); ++y) {
    const float* row = error.view().row(y);
    for (std::size_t i = 0; i < static_cast<std::size_t>(error.width()) * channels; ++i)
      sums[i % channels] += static_cast<double>(row[i]) * row[i];
  }
  for (double& sum : sums) sum = std::sqrt(sum / error.width() / error.height());
  return sums;
}

}  // namespace

FittedMap fitMap(const TimeSamples& samples, const FitOptions& options, Progress& progress) {
  checkSamples(samples);
  const TimeFit fit(samples.times, options.weights, options.degree);
  const Image<float>& first = samples.maps[0];
  const std::size_t count = samples.seriesCount();
  const auto terms = static_cast<std::size_t>(options.degree) + 1;
  FittedMap out;
  out.map = {.name = samples.name,
             .coefficients = std::vector<Image<float>>(
                 terms, Image<float>(first.width(), first.height(), first.channels())),
             .low = samples.low,
             .high = samples.high};
  out.error = Image<float>(first.width(), first.height(), first.channels());
  std::vector<float*> coefficients;
  coefficients.reserve(terms);
  for (Image<float>& c : out.map.coefficients) coefficients.push_back(c.texels().data());
  const std::vector<const float*> planes = samples.planes();

  progress.begin("fitting " + samples.name, 2);
  const Basis basis = basisOf(options.degree);
  Projection(fit, options.bounded ? Basis::kLegendre : basis).apply(planes, coefficients, count);
  if (options.bounded) {
    out.bounded_series = BoundedFit(fit, samples.low, samples.high).bound(coefficients, count);
    StbrdfSet one{.degree = options.degree, .basis = Basis::kLegendre, .maps = {}, .facts = {}};
    one.maps.push_back(std::move(out.map));
    convert(one, basis);
    out.map = std::move(one.maps[0]);
    for (std::size_t k = 0; k < terms; ++k)
      coefficients[k] = out.map.coefficients[k].texels().data();
  }
  progress.step();
  const std::vector<const float*> fitted(coefficients.begin(), coefficients.end());
  residualRms(fit, basis, planes, fitted, out.error.texels());
  out.rms = rmsOf(out.error);
  progress.step();
  return out;
}

}  // namespace patina::stbrdf
