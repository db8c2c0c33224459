// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/enlarge.h"

#include <algorithm>
#include <cmath>

#include "processing/image/parallel_rows.h"
#include "processing/patch/euclidean.h"

namespace patina::texture_optimization {
namespace {

double weightOf(const EnlargeOptions& options, const std::string& map) {
  if (map == "Diffuse") return options.diffuse;
  if (map == "Specular") return options.specular;
  return map == "Roughness" ? options.roughness : 0;
}

// Three equal channels of a grey map count once.
bool isGrey(const stbrdf::TimeMap& map) {
  for (const Image<float>& c : map.coefficients)
    for (std::size_t i = 0; i < c.texels().size(); i += static_cast<std::size_t>(c.channels()))
      for (int k = 1; k < c.channels(); ++k)
        if (c.texels()[i] != c.texels()[i + static_cast<std::size_t>(k)]) return false;
  return true;
}

// [h][w][channels * terms] of the maps that are compared, and each channel's weight.
Image<float> compared(const stbrdf::StbrdfSet& set, const EnlargeOptions& options,
                      std::vector<double>& weights) {
  struct Plane {
    const stbrdf::TimeMap* map;
    int channel;
  };
  std::vector<Plane> planes;
  for (const stbrdf::TimeMap& map : set.maps) {
    const double weight = weightOf(options, map.name);
    if (weight == 0) continue;
    const int channels =
        map.name == "Roughness" && isGrey(map) ? 1 : map.coefficients[0].channels();
    for (int c = 0; c < channels; ++c) {
      planes.push_back({&map, c});
      weights.push_back(weight);
    }
  }
  const int terms = set.degree + 1;
  Image<float> out(set.size().width, set.size().height,
                   std::max(1, static_cast<int>(planes.size()) * terms));
  forEachRow(out.height(), out.width() * 4LL * out.channels(), [&](int y) {
    for (int x = 0; x < out.width(); ++x) {
      float* to = &out.at(x, y);
      for (const Plane& plane : planes)
        for (const Image<float>& c : plane.map->coefficients) *to++ = c.at(x, y, plane.channel);
    }
  });
  return out;
}

// Every coefficient of every map, voted together: what the votes are is asked once.
void showAll(const stbrdf::StbrdfSet& from, const OptimizedField& field, stbrdf::StbrdfSet& to) {
  std::vector<const Image<float>*> parts;
  std::vector<Image<float>*> into;
  int channels = 0;
  for (const stbrdf::TimeMap& map : from.maps) {
    to.maps.push_back({.name = map.name, .coefficients = {}, .low = map.low, .high = map.high});
    for (const Image<float>& c : map.coefficients) {
      to.maps.back().coefficients.emplace_back(field.size.width, field.size.height, c.channels());
      parts.push_back(&c);
      channels += c.channels();
    }
  }
  for (stbrdf::TimeMap& map : to.maps)
    for (Image<float>& c : map.coefficients) into.push_back(&c);
  Image<float> packed(field.source.width, field.source.height, channels);
  forEachRow(packed.height(), std::int64_t{packed.width()} * channels, [&](int y) {
    for (int x = 0; x < packed.width(); ++x) {
      float* at = &packed.at(x, y);
      for (const Image<float>* part : parts)
        at = std::copy_n(&part->at(x, y), part->channels(), at);
    }
  });
  sharpVote(packed.view(), field.votes(), field.gain, [&](int y, std::span<const float> row) {
    const float* at = row.data();
    for (int x = 0; x < field.size.width; ++x)
      for (Image<float>* image : into) {
        std::copy_n(at, image->channels(), &image->at(x, y));
        at += image->channels();
      }
  });
}

}  // namespace

void EnlargeOptions::check() const {
  for (const double weight : {diffuse, specular, roughness})
    if (!(weight >= 0 && std::isfinite(weight)))
      throw ProcessingError(Exit::kUsage,
                            "a weight is " + std::to_string(weight) + "; weights are 0 or more");
  if (diffuse + specular + roughness == 0)
    throw ProcessingError(Exit::kUsage, "all weights are 0: nothing is left to compare");
}

std::int64_t enlargeBytes(const stbrdf::StbrdfSet& set, SizePx size) {
  std::int64_t channels = 0;
  for (const stbrdf::TimeMap& map : set.maps) channels += map.coefficients[0].channels();
  const std::int64_t source = std::int64_t{set.size().width} * set.size().height,
                     result = std::int64_t{size.width} * size.height, terms = set.degree + 1;
  // Of a source texel: the set, three times beside it for features, components and votes, and the
  // search's index and counts. Of a result texel: the set, what is compared as integers, and the
  // field with what the search needs.
  constexpr std::int64_t kFloat = 4, kInteger = 2, kComparedMost = 7, kSearch = 200, kField = 60;
  return source * (4 * kFloat * channels * terms + kSearch) +
         result *
             ((kFloat * channels + kInteger * std::min(channels, kComparedMost)) * terms + kField);
}

Enlarged enlarge(const stbrdf::StbrdfSet& set, const EnlargeOptions& options,
                 const Constraints& constraints, Progress& progress) {
  options.check();
  options.optimize.check(set.size());
  Enlarged out;
  {
    std::vector<double> weights;
    const Image<float> coefficients = compared(set, options, weights);
    if (weights.empty())
      throw ProcessingError(Exit::kUsage, "the set has none of the maps that have a weight");
    const Image<float> features =
        patch::euclidean(coefficients.view(), stbrdf::gramMatrix(set.basis, set.degree), weights);
    out.field = optimize(features.view(), options.optimize, constraints, progress);
  }
  out.set = {.degree = set.degree,
             .basis = set.basis,
             .model = set.model,
             .roughness = set.roughness,
             .maps = {},
             .facts = set.facts};
  showAll(set, out.field, out.set);
  return out;
}

}  // namespace patina::texture_optimization
