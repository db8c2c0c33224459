// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/response.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/photo.hpp>
#include <optional>
#include <string>

#include "processing/image/cv_bridge.h"

namespace patina::calibration {
namespace {

constexpr int kExposuresMin = 3;
constexpr double kRatioMin = 2, kResidualMax = 0.1, kFallMax = 0.05;
// Of the mean weight of a code. Strong, as brackets of an even scene leave waves along the curve
// nearly free; a curve that bends as a power or a logarithm does is left alone to 0.2 %.
constexpr double kSmoothShare = 1e3;
constexpr int kEvenCodes = 16;                // highest less lowest code of a block
constexpr int kObservedMin = 2000;            // pairs of block means
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
    if (!(bracket.exposure_s > 0)) refuse("an exposure is not known");
    least = std::min(least, bracket.exposure_s);
    most = std::max(most, bracket.exposure_s);
  }
  report.ratio = most / least;
  if (!(report.ratio >= kRatioMin)) refuse("the exposures are all alike");
}

cv::Mat solve(const std::vector<Bracket>& brackets, const ResponseOptions& options) {
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  for (const Bracket& bracket : brackets) {
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

// Mean codes of even blocks, which noise and rounding hardly move. A single noisy code would be
// drawn towards the codes that the scene has most of.
struct Blocks {
  std::vector<std::vector<float>> mean;  // [bracket][block]; negative: not even, black or white
};
Blocks blocksOf(const std::vector<Bracket>& brackets, int channel, int side) {
  Blocks blocks;
  for (const Bracket& bracket : brackets) {
    const ImageView<const std::uint8_t> codes = bracket.codes.view();
    std::vector<float>& mean = blocks.mean.emplace_back();
    for (int y0 = 0; y0 + side <= codes.height; y0 += side)
      for (int x0 = 0; x0 + side <= codes.width; x0 += side) {
        int low = kCodes, high = 0, sum = 0;
        for (int y = y0; y < y0 + side; ++y)
          for (int x = x0; x < x0 + side; ++x) {
            const int code = codes.at(x, y, channel);
            low = std::min(low, code);
            high = std::max(high, code);
            sum += code;
          }
        const bool even = low >= kCodeLow && high <= kCodeHigh && high - low <= kEvenCodes;
        mean.push_back(even ? static_cast<float>(sum) / static_cast<float>(side * side) : -1.0f);
      }
  }
  return blocks;
}

// The normal equations of Debevec and Malik's equation 3 for g, the logarithm of light, linear
// between codes. The light of a block drops out of the difference of two exposures.
class LogResponse {
 public:
  explicit LogResponse(const std::array<double, kCodes>& start) {
    for (int z = kCodeLow; z <= kCodeHigh; ++z)
      slope_[z] = std::max(1e-3, std::log(start[z + 4] / std::max(1e-9, start[z - 4])) / 8);
  }
  // Weights are those of equal noise in codes.
  void observe(float a, float b, double difference) {
    const int ka = static_cast<int>(a), kb = static_cast<int>(b);
    const double fa = a - static_cast<float>(ka), fb = b - static_cast<float>(kb);
    const double w = 1 / (slope_[ka] * slope_[ka] + slope_[kb] * slope_[kb]);
    const std::array<int, 4> at{ka, ka + 1, kb, kb + 1};
    const std::array<double, 4> share{1 - fa, fa, fb - 1, -fb};
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::size_t q = 0; q < 4; ++q) normal_(at[p], at[q]) += w * share[p] * share[q];
      right_(at[p]) += w * share[p] * difference;
    }
    ++observed_;
  }
  int observed() const { return observed_; }
  // With a penalty on the third difference, by which it goes on to the last code.
  std::optional<Eigen::VectorXd> solve() {
    const double weight = kSmoothShare * normal_.trace() / kCodes;
    constexpr std::array<double, 4> kThird{-1, 3, -3, 1};
    for (int z = kCodeLow; z + 3 < kCodes; ++z)
      for (int p = 0; p < 4; ++p)
        for (int q = 0; q < 4; ++q)
          normal_(z + p, z + q) +=
              weight * kThird[static_cast<std::size_t>(p)] * kThird[static_cast<std::size_t>(q)];
    for (int z = 0; z < kCodes; ++z)
      if (z < kCodeLow || z == kCodes / 2) normal_(z, z) += 1e3 * weight + 1;
    Eigen::VectorXd g = normal_.ldlt().solve(right_);
    if (!g.allFinite()) return std::nullopt;
    return g;
  }

 private:
  std::array<double, kCodes> slope_{};  // of the logarithm, a code
  Eigen::MatrixXd normal_ = Eigen::MatrixXd::Zero(kCodes, kCodes);
  Eigen::VectorXd right_ = Eigen::VectorXd::Zero(kCodes);
  int observed_ = 0;
};

// `light` is where it starts, and changes; left as it is where the scene has too few even blocks.
int refine(const std::vector<Bracket>& brackets, int channel, int side,
           std::array<double, kCodes>& light) {
  const Blocks blocks = blocksOf(brackets, channel, side);
  LogResponse response(light);
  for (std::size_t i = 0; i < brackets.size(); ++i)
    for (std::size_t j = i + 1; j < brackets.size(); ++j) {
      const double difference = std::log(brackets[i].exposure_s / brackets[j].exposure_s);
      for (std::size_t k = 0; k < blocks.mean[i].size(); ++k)
        if (blocks.mean[i][k] >= 0 && blocks.mean[j][k] >= 0)
          response.observe(blocks.mean[i][k], blocks.mean[j][k], difference);
    }
  if (response.observed() < kObservedMin) return 0;
  const std::optional<Eigen::VectorXd> g = response.solve();
  if (!g) return 0;
  const double middle = light[kCodes / 2], low = light[kCodeLow];
  for (int z = kCodeLow; z < kCodes; ++z) light[z] = middle * std::exp((*g)(z) - (*g)(kCodes / 2));
  for (int z = 0; z < kCodeLow; ++z) light[z] *= light[kCodeLow] / low;
  return response.observed();
}

double residualOf(const std::vector<Bracket>& brackets, const ResponseCurve& curve) {
  const std::size_t samples = brackets[0].codes.texels().size(),
                    channels = static_cast<std::size_t>(brackets[0].codes.channels());
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto exposed = [&](const Bracket& bracket) {
      const int code = bracket.codes.texels()[i];
      return code >= kCodeLow && code <= kCodeHigh;
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
    if (options.block_px > 0)
      out.report.block_pairs += refine(brackets, c, options.block_px, light);
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
