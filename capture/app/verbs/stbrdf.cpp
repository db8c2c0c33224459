// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf: materials that change, as polynomials of time. This file: info, and what its verbs
// share.
#include <algorithm>
#include <array>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

void info(Context& context, const std::string& folder) {
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(folder, context.progress);
  context.out.say(folder + ": " + std::to_string(set.size().width) + "x" +
                  std::to_string(set.size().height) + " texels, degree " +
                  std::to_string(set.degree) + " (" + nameOf(set.basis) + "), " + set.model + ", " +
                  set.roughness);
  constexpr int kTimes = 17;
  for (const stbrdf::TimeMap& map : set.maps) {
    float least = map.coefficients[0].at(0, 0), most = least;
    double moved = 0;
    const Image<float> start = evaluate(map, set.basis, 0, stbrdf::Clamp::kNone);
    for (int i = 0; i < kTimes; ++i) {
      const Image<float> at = evaluate(map, set.basis, i / (kTimes - 1.0), stbrdf::Clamp::kNone);
      for (std::size_t k = 0; k < at.texels().size(); ++k) {
        least = std::min(least, at.texels()[k]);
        most = std::max(most, at.texels()[k]);
        if (i == kTimes - 1) moved += std::abs(at.texels()[k] - start.texels()[k]);
      }
    }
    context.out.add(
        std::move(Item()
                      .set("map", map.name.c_str())
                      .set("channels", map.coefficients[0].channels())
                      .set("width_px", set.size().width)
                      .set("height_px", set.size().height)
                      .set("degree", set.degree)
                      .set("basis", nameOf(set.basis).c_str())
                      .set("low", Value{static_cast<double>(map.low)})
                      .set("high", Value{static_cast<double>(map.high)})
                      .set("least", Value{static_cast<double>(least)})
                      .set("most", Value{static_cast<double>(most)})
                      .set("change", Value{moved / static_cast<double>(start.texels().size())})));
  }
}

}  // namespace

stbrdf::SampleSet openSamples(const Context& context, const std::vector<std::string>& inputs) {
  stbrdf::SampleSet set =
      stbrdf::openSamples(std::vector<std::filesystem::path>(inputs.begin(), inputs.end()));
  if (!set.times_told)
    context.warn("nothing tells the times of the " + std::to_string(set.times.size()) +
                 " steps: taken as evenly spaced");
  return set;
}

std::vector<std::string> mapsToFit(const stbrdf::SampleSet& set,
                                   const std::vector<std::string>& asked) {
  if (!asked.empty()) return asked;
  std::vector<std::string> names;
  for (const char* name : {"Diffuse", "Specular", "Roughness", "Normal", "Height", "Occlusion"})
    if (set.maps.find(name) != set.maps.end()) names.emplace_back(name);
  return names;
}

void addStbrdfVerbs(Verb root) {
  Verb stbrdf = root.group("stbrdf", "Materials that change, as polynomials of time");
  addStbrdfFitVerb(stbrdf);
  auto folder = std::make_shared<std::string>();
  stbrdf
      .verb("info", "What a set holds", "patina stbrdf info rust",
            [folder](Context& context) { info(context, *folder); })
      .required("SET", *folder, "A folder of coefficients");
  addStbrdfReportVerb(stbrdf);
  addStbrdfEvaluateVerb(stbrdf);
  addStbrdfConvertVerb(stbrdf);
  addStbrdfEnlargeVerb(stbrdf);
  addStbrdfTransferVerb(stbrdf);
}

}  // namespace patina::app
