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

constexpr int kLeadingComponents = 8, kFurtherComponents = 8, kFewComponents = 4,
              kGuideComponents = 8;

struct Components {
  std::size_t rank = 0;
  std::vector<float> scores;  // [texels of all images][rank]
  double longest = 0;
};

std::int64_t texelsOf(ImageView<const float> image) {
  return static_cast<std::int64_t>(image.width) * image.height;
}

// Principal components of the texels of all images together, which have the same channels.
Components componentsOf(std::span<const ImageView<const float>> images, Progress& progress) {
  const std::int64_t n = images[0].channels;
  std::int64_t m = 0;
  for (const ImageView<const float>& image : images) m += texelsOf(image);
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min(m, n));
  options.centre = true;
  const auto texel = [&](std::int64_t i) {
    std::size_t image = 0;
    while (i >= texelsOf(images[image])) i -= texelsOf(images[image++]);
    const int width = images[image].width;
    return &images[image].at(static_cast<int>(i % width), static_cast<int>(i / width));
  };
  const auto block = [&](std::int64_t first, std::int64_t count, std::span<float> to) {
    for (std::int64_t i = 0; i < count; ++i) {
      const float* from = texel(first + i);
      for (std::int64_t c = 0; c < n; ++c) to[static_cast<std::size_t>(c * count + i)] = from[c];
    }
  };
  decomposition::TemporalSvd svd = decomposition::temporalSvd(m, n, block, options, progress);
  Components out;
  out.rank = static_cast<std::size_t>(svd.rank);
  out.scores = std::move(svd.scores);
  for (std::size_t i = 0; i < out.scores.size(); i += out.rank) {
    double length = 0;
    for (std::size_t k = 0; k < out.rank; ++k)
      length += static_cast<double>(out.scores[i + k]) * out.scores[i + k];
    out.longest = std::max(out.longest, std::sqrt(length));
  }
  return out;
}

// How many there are, once scaled and rounded: nothing but zeros come after them.
int countOf(const Components& components, double scale) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < components.scores.size(); i += components.rank)
    for (std::size_t k = count; k < components.rank; ++k)
      if (std::lrint(scale * static_cast<double>(components.scores[i + k])) != 0) count = k + 1;
  return static_cast<int>(count);
}

// The scores from component `component` of texel `first` on, scaled, into channels [from, to).
void place(const Components& components, std::int64_t first, int component, double scale, int from,
           int to, Image<std::int16_t>& image) {
  const int count = std::min(to - from, static_cast<int>(components.rank) - component);
  const float* score =
      &components.scores[static_cast<std::size_t>(first) * components.rank] + component;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x, score += components.rank)
      for (int k = 0; k < count; ++k)
        (&image.at(x, y, from))[k] =
            static_cast<std::int16_t>(std::lrint(scale * static_cast<double>(score[k])));
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

CompactFeatures compactFeatures(ImageView<const float> features, const GuidePair& guides, int patch,
                                Progress& progress) {
  PATINA_CHECK(patch >= 1 && !features.empty());
  const bool guided = !guides.source.empty();
  PATINA_CHECK(!guided || (guides.source.size() == features.size() && !guides.target.empty() &&
                           guides.source.channels == guides.target.channels));
  const ImageView<const float> own[] = {features}, both[] = {guides.source, guides.target};
  const Components style = componentsOf(own, progress);
  const Components guide = guided ? componentsOf(both, progress) : Components{};
  const double longest = std::sqrt(style.longest * style.longest + guide.longest * guide.longest);
  CompactFeatures out;
  out.scale = longest > 0 ? 32767.0 / (2 * patch) / longest : 1;
  const int styles = countOf(style, out.scale), guide_count = countOf(guide, out.scale);
  const auto addStyle = [&](int component, int room, int behind) {
    CompactPart& part = out.parts.emplace_back();
    part.texels = Image<std::int16_t>(features.width, features.height, room + behind);
    place(style, 0, component, out.scale, 0, room, part.texels);
  };
  const auto addGuide = [&](int component, CompactPart& part) {
    const int to = part.texels.channels();
    place(guide, 0, component, out.scale, to - kGuideComponents, to, part.texels);
    part.guide = Image<std::int16_t>(guides.target.width, guides.target.height, kGuideComponents);
    place(guide, texelsOf(features), component, out.scale, 0, kGuideComponents, part.guide);
  };
  const int first = !guided && styles <= kFewComponents ? kFewComponents : kLeadingComponents;
  addStyle(0, first, guided ? kGuideComponents : 0);
  if (guided) addGuide(0, out.parts[0]);
  for (int component = first; component < styles; component += kFurtherComponents)
    addStyle(component, styles - component <= kFewComponents ? kFewComponents : kFurtherComponents,
             0);
  for (int component = kGuideComponents; component < guide_count; component += kGuideComponents) {
    CompactPart& part = out.parts.emplace_back();
    part.texels = Image<std::int16_t>(features.width, features.height, kGuideComponents);
    addGuide(component, part);
  }
  return out;
}

}  // namespace patina::patch
