// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/response.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/photo.hpp>
#include <optional>
#include <string>

#include "calibration/sensor/curve_fit.h"
#include "processing/image/cv_bridge.h"

namespace patina::calibration {
namespace {

constexpr int kExposuresMin = 3;
constexpr double kRatioMin = 2, kResidualMax = 0.1, kFallMax = 0.05;
constexpr int kCodesMin = 64;                 // different ones that a colour must show
constexpr int kCodeLow = 5, kCodeHigh = 250;  // between them a texel counts as exposed
constexpr const char* kShoot =
    "shoot at least three exposures of a still scene under steady light, a stop or two apart, from "
    "nearly black to nearly white";

[[noreturn]] void refuse(const std::string& what) {
  throw CalibrationError(Exit::kBadData, "response: " + what + ": " + kShoot);
}

using Counts = std::array<std::array<std::int64_t, kCodes>, 3>;

Counts countCodes(const std::vector<Bracket>& brackets) {
  Counts counts{};
  for (const Bracket& bracket : brackets) {
    const auto channels = static_cast<std::size_t>(bracket.codes.channels());
    const std::vector<std::uint8_t>& codes = bracket.codes.texels();
    for (std::size_t i = 0; i < codes.size(); ++i) ++counts[i % channels][codes[i]];
  }
  return counts;
}

std::int64_t sumOf(const Bracket& bracket) {
  const std::vector<std::uint8_t>& codes = bracket.codes.texels();
  return std::accumulate(codes.begin(), codes.end(), std::int64_t{0});
}

// Exposure 0 is a covered lens: as dark as any, or its exposure is merely missing.
void checkCovered(const std::vector<Bracket>& brackets) {
  std::int64_t covered = 0, darkest = std::numeric_limits<std::int64_t>::max();
  for (const Bracket& bracket : brackets)
    if (bracket.exposure_s == 0)
      covered = std::max(covered, sumOf(bracket));
    else
      darkest = std::min(darkest, sumOf(bracket));
  if (covered > darkest)
    refuse(
        "a picture of exposure 0, a covered lens, is not the darkest: its exposure is not known");
}

void checkBrackets(const std::vector<Bracket>& brackets, ResponseReport& report) {
  report.exposures = static_cast<int>(brackets.size());
  if (report.exposures < kExposuresMin)
    refuse(std::to_string(report.exposures) + " exposures are no brackets");
  double least = 1e300, most = 0;
  for (const Bracket& bracket : brackets) {
    if (bracket.codes.size() != brackets[0].codes.size() ||
        bracket.codes.channels() != brackets[0].codes.channels())
      refuse("the pictures differ in size");
    if (bracket.codes.channels() != 1 && bracket.codes.channels() != 3)
      refuse("the pictures have neither one channel nor three");
    if (!(bracket.exposure_s >= 0)) refuse("an exposure is not known");
    if (bracket.exposure_s == 0) continue;
    least = std::min(least, bracket.exposure_s);
    most = std::max(most, bracket.exposure_s);
  }
  report.ratio = most / least;
  if (!(report.ratio >= kRatioMin)) refuse("the exposures are all alike");
  checkCovered(brackets);
}

cv::Mat solve(const std::vector<Bracket>& brackets, const ResponseOptions& options) {
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  for (const Bracket& bracket : brackets) {
    if (bracket.exposure_s == 0) continue;
    const cv::Mat codes = asMat(bracket.codes.view());
    pictures.push_back(codes);
    // OpenCV 4.6 writes three channels' sums whatever there are.
    if (codes.channels() == 1) cv::merge(std::vector<cv::Mat>(3, codes), pictures.back());
    times.push_back(static_cast<float>(bracket.exposure_s));
  }
  cv::Mat response;
  try {
    if (options.method == ResponseMethod::kDebevecMalik)
      cv::createCalibrateDebevec(options.samples, static_cast<float>(options.smoothness), false)
          ->process(pictures, response, times);
    else
      cv::createCalibrateRobertson(options.iterations, 1e-5f)->process(pictures, response, times);
  } catch (const cv::Exception& error) {
    refuse(std::string("OpenCV finds none (") + error.what() + ")");
  }
  return response;
}

// Codes that no picture shows lie between those that do; black is 0 when it was not seen.
void fillGaps(std::array<double, kCodes>& light, const std::array<std::int64_t, kCodes>& counts) {
  int before = -1;
  for (int code = 0; code < kCodes; ++code) {
    if (counts[code] == 0 || code == kCodes - 1) continue;
    const double from = before < 0 ? 0 : light[before];
    const int start = before < 0 ? 0 : before;
    for (int gap = before + 1; gap < code; ++gap)
      light[gap] = from + (light[code] - from) * (gap - start) / (code - start);
    before = code;
  }
  // The last code means "at least": it goes on as the curve does before it.
  const int known = std::max(before, 2);
  const double slope = (light[known] - light[known - 2]) / 2;
  for (int code = known + 1; code < kCodes; ++code)
    light[code] = light[known] + slope * (code - known);
}

// Pool adjacent violators: the nearest rising curve, weighted by how often a code was seen. Returns
// the largest step down there was, of the top.
double makeRising(std::array<double, kCodes>& light,
                  const std::array<std::int64_t, kCodes>& counts) {
  struct Block {
    double value, weight;
    int codes;
  };
  double fall = 0;
  std::vector<Block> blocks;
  for (int code = 0; code < kCodes; ++code) {
    if (code > 0) fall = std::max(fall, light[code - 1] - light[code]);
    blocks.push_back({light[code], static_cast<double>(counts[code]) + 1, 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].value > blocks.back().value) {
      const Block last = blocks.back();
      blocks.pop_back();
      Block& into = blocks.back();
      into.value =
          (into.value * into.weight + last.value * last.weight) / (into.weight + last.weight);
      into.weight += last.weight;
      into.codes += last.codes;
    }
  }
  int code = 0;
  for (const Block& block : blocks)
    for (int i = 0; i < block.codes; ++i) light[code++] = block.value;
  return light[kCodes - 1] > 0 ? fall / light[kCodes - 1] : 1;
}

// `light` is where it starts, and changes; left as it is where too few sums can be compared.
void refine(const std::vector<Bracket>& brackets, int channel, int block_px,
            std::array<double, kCodes>& light, ResponseReport& report) {
  const std::optional<CurveFit> fit = fitCurve(brackets, channel, block_px, light);
  if (!fit) return;
  light = fit->light;
  report.block_sums += fit->observed;
}

double residualOf(const std::vector<Bracket>& brackets, const ResponseCurve& curve) {
  const std::size_t samples = brackets[0].codes.texels().size(),
                    channels = static_cast<std::size_t>(brackets[0].codes.channels());
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto exposed = [&](const Bracket& bracket) {
      const int code = bracket.codes.texels()[i];
      return bracket.exposure_s > 0 && code >= kCodeLow && code <= kCodeHigh;
    };
    const auto lightOf = [&](const Bracket& bracket) {
      return static_cast<double>(curve.light[i % channels][bracket.codes.texels()[i]]);
    };
    double light = 0, exposure_s = 0;
    int used = 0;
    for (const Bracket& bracket : brackets)
      if (exposed(bracket)) {
        light += lightOf(bracket);
        exposure_s += bracket.exposure_s;
        ++used;
      }
    if (used < 2 || !(light > 0)) continue;
    for (const Bracket& bracket : brackets)
      if (exposed(bracket)) {
        const double off = lightOf(bracket) / bracket.exposure_s / (light / exposure_s) - 1;
        squares += off * off;
        count += 1;
      }
  }
  if (count < 1000) refuse("too few texels are neither black nor white in two exposures");
  return std::sqrt(squares / count);
}

}  // namespace

void ResponseOptions::check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw CalibrationError(Exit::kUsage, std::string("response: ") + what);
  };
  require(samples >= 50 && samples <= 1000, "samples must lie in [50, 1000]");
  require(smoothness > 0 && smoothness <= 1000, "smoothness must lie in (0, 1000]");
  require(block_px >= 0 && block_px <= 64, "block_px must lie in [0, 64]");
  require(iterations >= 1 && iterations <= 1000, "iterations must lie in [1, 1000]");
}

Response measureResponse(const std::vector<Bracket>& brackets, const ResponseOptions& options,
                         Progress& progress) {
  options.check();
  Response out;
  checkBrackets(brackets, out.report);
  progress.begin("response", 2);
  const Counts counts = countCodes(brackets);
  const int channels = brackets[0].codes.channels();
  for (int c = 0; c < channels; ++c) {
    const auto seen = std::count_if(counts[c].begin() + kCodeLow, counts[c].begin() + kCodeHigh + 1,
                                    [](std::int64_t n) { return n > 0; });
    out.report.codes_seen[c] =
        static_cast<int>(std::ranges::count_if(counts[c], [](std::int64_t n) { return n > 0; }));
    if (seen < kCodesMin)
      refuse("only " + std::to_string(seen) + " codes between black and white are seen");
  }
  const cv::Mat solved = solve(brackets, options);
  progress.step();
  for (int c = 0; c < channels; ++c) {
    std::array<double, kCodes> light{};
    for (int code = 0; code < kCodes; ++code)
      if (counts[c][code] > 0) light[code] = solved.ptr<float>(code)[c];  // of others it is 0 / 0
    if (!std::ranges::all_of(light, [](double v) { return std::isfinite(v); }))
      refuse("the curve is not finite");
    fillGaps(light, counts[c]);
    makeRising(light, counts[c]);
    if (options.block_px > 0) refine(brackets, c, options.block_px, light, out.report);
    out.report.fall_mended = std::max(out.report.fall_mended, makeRising(light, counts[c]));
    for (int code = 0; code < kCodes; ++code)
      out.curve.light[c][code] = static_cast<float>(std::max(0.0, light[code] / light[kCodes - 1]));
  }
  for (int c = channels; c < 3; ++c) out.curve.light[c] = out.curve.light[0];
  if (out.report.fall_mended > kFallMax) refuse("the curve does not rise");
  out.report.residual = residualOf(brackets, out.curve);
  if (!(out.report.residual <= kResidualMax))
    refuse("one light gives numbers " + std::to_string(std::lround(100 * out.report.residual)) +
           " % apart: the scene or the light changed, or the exposures are wrong");
  progress.step();
  return out;
}

Image<float> linearBy(const ResponseCurve& curve, ImageView<const std::uint8_t> codes) {
  Image<float> out(codes.width, codes.height, codes.channels);
  const ImageView<float> to = out.view();
  tbb::parallel_for(0, codes.height, [&](int y) {
    for (int x = 0; x < codes.width; ++x)
      for (int c = 0; c < codes.channels; ++c)
        to.at(x, y, c) = curve.light[static_cast<std::size_t>(std::min(c, 2))][codes.at(x, y, c)];
  });
  return out;
}

}  // namespace patina::calibration
