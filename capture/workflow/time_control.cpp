// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/time_control.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "processing/image/expression.h"
#include "processing/image/picture_file.h"
#include "processing/image/warp.h"

namespace patina::workflow {
namespace {

constexpr int kRateKeys = 33;  // of a rate that changes over time
constexpr double kSkyReachTexels = 64;
constexpr int kShadowRays = 16;

const std::vector<std::string>& variableNames() {
  static const std::vector<std::string> names{"x",     "y",         "t",     "map",    "height",
                                              "slope", "curvature", "light", "shadow", "sky"};
  return names;
}

// One channel, of the texture's size: EXR as it is, others as displayed.
Image<float> greyPicture(const std::filesystem::path& file, SizePx size) {
  const Picture picture = readPicture(file);
  Image<float> grey(picture.linear.width(), picture.linear.height(), 1);
  const int channels = picture.linear.channels();
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      float sum = 0;
      for (int c = 0; c < channels; ++c) {
        const float v = picture.linear.at(x, y, c);
        sum += picture.format == PictureFormat::kExr ? v : srgbFromLinear(v);
      }
      grey.at(x, y) = sum / static_cast<float>(channels);
    }
  if (grey.size() == size) return grey;
  return resizeArea(std::as_const(grey).view(), size);
}

// The planes that formulas name, each made when it is first asked for.
class Planes {
 public:
  Planes(const TimeControl& control, const ttf::TtfInfo& input)
      : control_(control),
        size_{input.width, input.height},
        mm_per_texel_(control.mm_per_texel > 0 ? control.mm_per_texel : input.mm_per_texel) {}

  const Image<float>& of(const std::string& name) {
    const auto [it, is_new] = planes_.try_emplace(name);
    if (is_new) it->second = make(name);
    return it->second;
  }

 private:
  Image<float> make(const std::string& name) {
    if (name == "map") {
      need(!control_.map.empty(), name, "a picture: --map FILE");
      return greyPicture(control_.map, size_);
    }
    if (name == "height") return heights();
    const mesh::HeightMap surface = surfaceFor(name);
    if (name == "slope") return mesh::slopeOf(surface);
    if (name == "curvature") return mesh::meanCurvatureOf(surface);
    if (name == "sky") return mesh::skyShareOf(surface, kSkyReachTexels * mm_per_texel_);
    need(control_.lamp.has_value(), name, "a light: --light X,Y,Z or --lamp X,Y,Z");
    if (name == "shadow")
      return mesh::shadowOf(surface, *control_.lamp,
                            {control_.lamp_radius, control_.lamp_radius > 0 ? kShadowRays : 1});
    Image<float> light = mesh::lightRateOf(surface, *control_.lamp);
    const float most = *std::max_element(light.texels().begin(), light.texels().end());
    if (!(most > 0)) throw WorkflowError(Exit::kUsage, "the light reaches no texel");
    for (float& v : light.texels()) v /= most;
    return light;
  }

  Image<float> heights() {
    if (control_.height.empty()) return Image<float>(size_.width, size_.height, 1);  // flat
    Image<float> out = greyPicture(control_.height, size_);
    for (float& v : out.texels()) v *= static_cast<float>(control_.height_mm);
    return out;
  }

  mesh::HeightMap surfaceFor(const std::string& name) {
    need(mm_per_texel_ > 0, name, "the size of a texel: --mm-per-texel X");
    return {of("height").view(), mm_per_texel_};
  }

  static void need(bool there, const std::string& name, const std::string& what) {
    if (!there) throw WorkflowError(Exit::kUsage, "'" + name + "' needs " + what);
  }

  const TimeControl& control_;
  SizePx size_;
  double mm_per_texel_;
  std::map<std::string, Image<float>> planes_;
};

Image<float> worked(const std::string& formula, SizePx size, double t, Planes& planes) {
  Expression expression(formula, variableNames());
  std::vector<const Image<float>*> used;
  for (const std::string& name : variableNames())
    used.push_back(name.size() > 1 && expression.used().contains(name) ? &planes.of(name)
                                                                       : nullptr);
  Image<float> out(size.width, size.height, 1);
  const double half = std::min(size.width, size.height) / 2.0;
  std::vector<double> values(used.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      values[0] = (x + 0.5 - size.width / 2.0) / half;
      values[1] = (size.height / 2.0 - y - 0.5) / half;
      values[2] = t;
      for (std::size_t i = 3; i < used.size(); ++i)
        if (used[i]) values[i] = used[i]->at(x, y);
      out.at(x, y) = static_cast<float>(expression.at(values));
    }
  return out;
}

}  // namespace

void controlTime(const TimeControl& control, const ttf::TtfInfo& input,
                 ttf::RetimeOptions& options) {
  const std::string rate = !control.rate.empty() ? control.rate : control.map.empty() ? "" : "map";
  if (rate.empty() && control.start.empty())
    throw WorkflowError(Exit::kUsage,
                        "how fast should what age? Give --rate FORMULA, --start FORMULA or --map "
                        "FILE");
  Planes planes(control, input);
  const SizePx size{input.width, input.height};
  const double length_s = input.time_s.back() - input.time_s.front();
  options.rates.clear();
  if (!rate.empty()) {
    const bool changes = Expression(rate, variableNames()).used().contains("t");
    const double end_s = options.duration_s.value_or(length_s);
    for (int k = 0; k < (changes ? kRateKeys : 1); ++k) {
      const double t = changes ? k / (kRateKeys - 1.0) : 0;
      options.rates.push_back({t * end_s, worked(rate, size, t, planes)});
    }
  }
  if (control.start.empty()) return;
  options.start_s = worked(control.start, size, 0, planes);
  for (float& v : options.start_s.texels()) v *= static_cast<float>(length_s);
}

}  // namespace patina::workflow
