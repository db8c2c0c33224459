// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/euclidean.h"

#include <algorithm>
#include <cmath>

#include "processing/decomposition/temporal_svd.h"
#include "processing/image/parallel_rows.h"

namespace patina::patch {
namespace {

// Lower triangle of G = L L^t, row-major.
std::vector<double> choleskyOf(std::span<const double> gram, std::size_t n) {
  std::vector<double> l(n * n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = gram[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      PATINA_CHECK(i != j || sum > 0);
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
  return l;
}

}  // namespace

Image<float> euclidean(ImageView<const float> coefficients, std::span<const double> gram,
                       std::span<const double> weights) {
  const auto terms = static_cast<std::size_t>(std::lround(std::sqrt(gram.size())));
  PATINA_CHECK(terms * terms == gram.size() &&
               weights.size() * terms == static_cast<std::size_t>(coefficients.channels));
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < weights.size(); ++c) {
    if (!(weights[c] >= 0 && std::isfinite(weights[c])))
      throw ProcessingError(Exit::kUsage, "a channel's weight is " + std::to_string(weights[c]) +
                                              "; weights are 0 or more");
    if (weights[c] > 0) kept.push_back(c);
  }
  if (kept.empty())
    throw ProcessingError(Exit::kUsage, "all weights are 0: nothing is left to compare");
  const std::vector<double> l = choleskyOf(gram, terms);
  Image<float> out(coefficients.width, coefficients.height, static_cast<int>(kept.size() * terms));
  forEachRow(out.height(), out.width() * 8LL * out.channels(), [&](int y) {
    for (int x = 0; x < out.width(); ++x) {
      const auto in = coefficients.texel(x, y);
      const auto to = out.view().texel(x, y);
      for (std::size_t c = 0; c < kept.size(); ++c) {
        const double weight = std::sqrt(weights[kept[c]]);
        for (std::size_t j = 0; j < terms; ++j) {
          double sum = 0;
          for (std::size_t i = j; i < terms; ++i) sum += l[i * terms + j] * in[kept[c] * terms + i];
          to[c * terms + j] = static_cast<float>(weight * sum);
        }
      }
    }
  });
  return out;
}

CompactFeatures compactFeatures(ImageView<const float> features, int components, int patch,
                                Progress& progress) {
  PATINA_CHECK((components == 8 || components == 16) && patch >= 1 && !features.empty());
  const std::int64_t n = features.channels,
                     m = static_cast<std::int64_t>(features.width) * features.height;
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min<std::int64_t>(components, std::min(m, n)));
  options.centre = true;
  const auto block = [&](std::int64_t first, std::int64_t count, std::span<float> to) {
    for (std::int64_t i = 0; i < count; ++i) {
      const auto texel = features.texel(static_cast<int>((first + i) % features.width),
                                        static_cast<int>((first + i) / features.width));
      for (std::int64_t c = 0; c < n; ++c)
        to[static_cast<std::size_t>(c) * static_cast<std::size_t>(count) +
           static_cast<std::size_t>(i)] = texel[static_cast<std::size_t>(c)];
    }
  };
  const decomposition::TemporalSvd svd = decomposition::temporalSvd(m, n, block, options, progress);
  const auto rank = static_cast<std::size_t>(svd.rank);
  double longest = 0;
  for (std::int64_t i = 0; i < m; ++i) {
    double length = 0;
    for (std::size_t k = 0; k < rank; ++k) {
      const double v = svd.scores[static_cast<std::size_t>(i) * rank + k];
      length += v * v;
    }
    longest = std::max(longest, length);
  }
  CompactFeatures out;
  out.left_out = svd.relative_error * svd.relative_error;
  out.scale = longest > 0 ? 32767.0 / (2 * patch) / std::sqrt(longest) : 1;
  out.texels = Image<std::int16_t>(features.width, features.height, components);
  for (std::int64_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < rank; ++k)
      out.texels.texels()[static_cast<std::size_t>(i) * static_cast<std::size_t>(components) + k] =
          static_cast<std::int16_t>(std::lrint(
              out.scale * static_cast<double>(svd.scores[static_cast<std::size_t>(i) * rank + k])));
  return out;
}

}  // namespace patina::patch
