// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/transfer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace patina::texture_optimization {
namespace {

// ITU-R BT.709, of linear light.
constexpr float kRed = 0.2126f, kGreen = 0.7152f, kBlue = 0.0722f;

Image<float> luminanceOf(ImageView<const float> rgb) {
  Image<float> out(rgb.width, rgb.height, 1);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x)
      out.at(x, y) = rgb.channels < 3 ? rgb.at(x, y, 0)
                                      : kRed * rgb.at(x, y, 0) + kGreen * rgb.at(x, y, 1) +
                                            kBlue * rgb.at(x, y, 2);
  return out;
}

const stbrdf::TimeMap& diffuseOf(const stbrdf::StbrdfSet& set) {
  const stbrdf::TimeMap* diffuse = set.find("Diffuse");
  if (diffuse == nullptr)
    throw ProcessingError(Exit::kUsage, "the set has no Diffuse map: there is nothing to transfer");
  return *diffuse;
}

}  // namespace

void TransferOptions::check() const {
  enlarge.check();
  if (!(time >= 0 && time <= 1))
    throw ProcessingError(Exit::kUsage,
                          "the time is " + std::to_string(time) + "; it lies between 0 and 1");
}

Image<float> equalised(ImageView<const float> grey) {
  struct Sample {
    float value;
    int x, y;
  };
  std::vector<Sample> samples;
  for (int y = 0; y < grey.height; ++y)
    for (int x = 0; x < grey.width; ++x) {
      if (!std::isfinite(grey.at(x, y)))
        throw ProcessingError(Exit::kBadData, "a value is no number at " + std::to_string(x) + "," +
                                                  std::to_string(y));
      samples.push_back({grey.at(x, y), x, y});
    }
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.value < b.value; });
  Image<float> out(grey.width, grey.height, 1);
  for (std::size_t first = 0, next = 0; first < samples.size(); first = next) {
    while (next < samples.size() && samples[next].value == samples[first].value) ++next;
    const double rank = (static_cast<double>(first) + static_cast<double>(next)) / 2 /
                        static_cast<double>(samples.size());
    for (std::size_t i = first; i < next; ++i)
      out.at(samples[i].x, samples[i].y) = static_cast<float>(rank);
  }
  return out;
}

double matchAt(double time, ImageView<const float> picture, stbrdf::StbrdfSet& set) {
  const auto diffuse = std::find_if(set.maps.begin(), set.maps.end(),
                                    [](const auto& map) { return map.name == "Diffuse"; });
  PATINA_CHECK(diffuse != set.maps.end() && picture.size() == set.size());
  const Image<float> then = evaluate(*diffuse, set.basis, time, stbrdf::Clamp::kNone);
  std::int64_t limited = 0;
  for (int y = 0; y < then.height(); ++y)
    for (int x = 0; x < then.width(); ++x)
      for (int c = 0; c < then.channels(); ++c) {
        const float is = then.at(x, y, c),
                    wanted = picture.at(x, y, std::min(c, picture.channels - 1));
        // is <= 0 falls into the second case, and so does what would turn the sign.
        const bool whole = wanted >= 0 && wanted <= kScaleMost * is && is > 0;
        const float factor = whole ? wanted / is : is > 0 && wanted >= 0 ? kScaleMost : 1;
        for (Image<float>& coefficient : diffuse->coefficients) coefficient.at(x, y, c) *= factor;
        if (whole) continue;
        diffuse->coefficients[0].at(x, y, c) += wanted - factor * is;
        ++limited;
      }
  return static_cast<double>(limited) / static_cast<double>(then.texels().size());
}

Transferred transfer(const stbrdf::StbrdfSet& set, ImageView<const float> picture,
                     const TransferOptions& options, Constraints constraints, Progress& progress) {
  options.check();
  const Image<float> then =
      evaluate(diffuseOf(set), set.basis, options.time, stbrdf::Clamp::kToRange);
  if (options.guide > 0)
    addGuide(constraints, equalised(luminanceOf(then.view()).view()).view(),
             equalised(luminanceOf(picture).view()).view(), options.guide);
  EnlargeOptions enlarging = options.enlarge;
  enlarging.optimize.size = picture.size();
  Transferred out{enlarge(set, enlarging, constraints, progress), {}};
  out.report.limited = matchAt(options.time, picture, out.larger.set);
  return out;
}

}  // namespace patina::texture_optimization
