// SPDX-License-Identifier: GPL-3.0-or-later
// From the twin's numbers back to the light it saw, with calibrations taken from its own pictures:
// photon transfer, dark, flat, defects, and a gain a lamp by the reference patch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <vector>

#include "calibration/sensor/masters.h"
#include "calibration/sensor/photon_transfer.h"
#include "calibration/sensor/radiance.h"
#include "calibration/sensor/response.h"
#include "processing/image/random.h"
#include "tests/calibration/sensor/tone_curve.h"
#include "tests/calibration/sensor/twin_shots.h"

namespace patina::calibration {
namespace {

using testing::TwinStudio;
using Lamps = std::array<double, 2>;  // level of key and fill

constexpr const char* kSize = "512x384";
constexpr double kExposure_s = 0.02;
const std::vector<double> kBrackets_s{0,      0.0001, 0.0002, 0.0004, 0.0007, 0.0013, 0.0021,
                                      0.0037, 0.0067, 0.0113, 0.0191, 0.0301, 0.0427};
constexpr int kFrames = 16, kMasterFrames = 64;

// A flat of one light state, and what the card looked like.
struct Flat {
  Master master;
  std::vector<float> card;
};

class Lab {
 public:
  Lab() : card_("grey_card", kSize), scene_("banana_ripening", kSize) {
    Progress progress;
    noise_ = measurePhotonTransfer(pairs({{0, 0}, {0, 0}}, 1),
                                   pairs({{0.1, 0}, {0.3, 0}, {0.7, 0}, {1.2, 0}, {2.6, 0}}, 100),
                                   {}, progress)
                 .noise;
    dark_ = stackDark(stack({0, 0}, 1000), progress);
  }
  // From here on the camera gives 8 bits by a tone curve; its response is measured from brackets,
  // the first of a covered lens.
  void giveCodes(const testing::Tone& tone) {
    Progress progress;
    tone_ = tone;
    response_.reset();
    std::vector<Bracket> brackets;
    for (const double t : kBrackets_s) {
      const auto key = static_cast<std::uint64_t>(1e6 * t);
      brackets.push_back(
          {testing::tonedCodes(
               exposed(card_, TwinStudio::shot(t > 0 ? 1 : 0, 0, std::max(t, 1e-4), key)), tone),
           t});
    }
    response_ = measureResponse(brackets, {.iterations = 20}, progress).curve;
    dark_ = stackDark(stack({0, 0}, 1000), progress);
  }

  Flat flatOf(Lamps lamps) {
    Progress progress;
    Flat flat{stackFlat(stack(lamps, 2000), std::as_const(dark_.image).view(), progress, cfa()),
              card_.maker.light(shot(lamps, 1))};
    return flat;
  }

  // Mean of the corrected frames while the lamps drift and flicker; the gain comes from the patch.
  Image<float> meanRadiance(Lamps lamps, double drift, const Flat& flat, SensorCorrection& used) {
    const DarkOf dark{std::as_const(dark_.image).view(), fromSeconds(kExposure_s), 20};
    const FoundDefects found =
        findDefects(dark, std::as_const(flat.master.image).view(), cfa(), {});
    used = prepareCorrection(size(), 1, cfa(), dark.dark, std::as_const(flat.master.image).view(),
                             defectsThatMatter(found.map, dark.exposure, 20));
    const double baseline = patchMean(exposed(scene_, shot(lamps, 5000)), used);
    Image<float> mean(size().width, size().height, 1), light = mean;
    saturated_.assign(mean.texels().size(), false);
    // The baseline is one shot too: its own noise, a share of the patch's mean, is in every gain.
    for (int i = 0; i < kFrames; ++i) {
      const double level = (1 + drift * i) * (1 + 0.001 * gaussian(hashSeed(8, i)));
      const RawMosaic& raw = exposed(
          scene_, shot({lamps[0] * level, lamps[1] * level}, 3000 + static_cast<std::uint64_t>(i)));
      const auto gain = static_cast<float>(baseline / patchMean(raw, used));
      Image<std::uint8_t> marks(size().width, size().height, 1);
      correct(raw, used, gain, light, marks.view());
      for (std::size_t k = 0; k < mean.texels().size(); ++k) {
        mean.texels()[k] += light.texels()[k] / kFrames;
        if ((marks.texels()[k] & kSaturated) != 0) saturated_[k] = true;
      }
    }
    return mean;
  }

  // What the mean should be: the scene's light over the card's, at the flat's level.
  Image<float> truth(Lamps lamps, const Flat& flat) {
    const std::vector<float> seen = scene_.maker.light(shot(lamps, 1));
    Image<float> out(size().width, size().height, 1);
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) {
        const std::size_t k = static_cast<std::size_t>(y) * out.width() + x;
        out.at(x, y) = static_cast<float>(
            seen[k] / flat.card[k] *
            flat.master.report.levels[static_cast<std::size_t>(colourAt(cfa(), x, y))]);
      }
    return out;
  }

  SizePx size() { return scene_.maker.layout().size; }
  const NoiseModels& noise() const { return noise_; }
  const ResponseCurve* response() const { return response_ ? &*response_ : nullptr; }
  const std::vector<bool>& saturated() const { return saturated_; }
  static ColourFilters cfa() { return RawMosaic{}.cfa; }

 private:
  static devices::twin::ShotLight shot(Lamps lamps, std::uint64_t key) {
    return TwinStudio::shot(lamps[0], lamps[1], kExposure_s, key);
  }
  PairSource pairs(std::vector<Lamps> levels, std::uint64_t key) {
    return [this, levels = std::move(levels), key,
            next = std::size_t{0}]() mutable -> std::optional<RawPair> {
      if (next == levels.size()) return std::nullopt;
      const Lamps lamps = levels[next++];
      return RawPair{card_.maker.expose(shot(lamps, key + 2 * next)),
                     card_.maker.expose(shot(lamps, key + 2 * next + 1))};
    };
  }
  std::function<PictureSource()> stack(Lamps lamps, std::uint64_t key) {
    return [this, lamps, key]() -> PictureSource {
      return [this, lamps, key, next = 0]() mutable -> std::optional<Image<float>> {
        if (next == kMasterFrames) return std::nullopt;
        const RawMosaic& raw =
            exposed(card_, shot(lamps, key + static_cast<std::uint64_t>(next++)));
        Image<float> light(raw.samples.width(), raw.samples.height(), 1);
        correct(raw, prepareCorrection(raw.samples.size(), 1, raw.cfa, {}, {}, {}), 1, light, {});
        return light;
      };
    };
  }
  void correct(const RawMosaic& raw, const SensorCorrection& correction, float gain,
               Image<float>& light, ImageView<std::uint8_t> marks) const {
    if (!response_) return toRadiance(raw, correction, {gain, gain, gain}, light.view(), marks);
    const Image<std::uint8_t> codes = testing::tonedCodes(raw, tone_);
    light = linearBy(*response_, codes.view());
    correctLinear(light.view(), correction, {gain, gain, gain});
    for (int y = 0; y < marks.height; ++y)
      for (int x = 0; x < marks.width; ++x) marks.at(x, y) = codes.at(x, y) == 255;
  }
  // Pictures are asked for again by every tone curve.
  const RawMosaic& exposed(TwinStudio& studio, const devices::twin::ShotLight& shot) {
    const auto [at, is_new] =
        exposed_.try_emplace({&studio, shot.levels[0], shot.levels[1], shot.noise_key});
    if (is_new) at->second = studio.maker.expose(shot);
    return at->second;
  }
  // Over the inner part of the grey patch.
  double patchMean(const RawMosaic& raw, const SensorCorrection& correction) {
    Image<float> light(size().width, size().height, 1);
    correct(raw, correction, 1, light, {});
    const RectPx p = scene_.maker.layout().patch_px;
    double sum = 0;
    for (int y = p.y + 8; y < p.y + p.height - 8; ++y)
      for (int x = p.x + 8; x < p.x + p.width - 8; ++x) sum += light.at(x, y);
    return sum;
  }

  TwinStudio card_, scene_;
  std::map<std::tuple<TwinStudio*, double, double, std::uint64_t>, RawMosaic> exposed_;
  testing::Tone tone_ = testing::kTones[0];
  std::optional<ResponseCurve> response_;
  NoiseModels noise_;
  Master dark_;
  std::vector<bool> saturated_;
};

struct Verdict {
  double error_ratio = 0;       // RMS error over predicted RMS
  double worst_tile_bias = 0;   // of 32x32 pixels, share
  double worst_level_bias = 0;  // of 1,000 pixels of one level
  double worst_level = 0;
  int repaired = 0, saturated = 0, pixels = 0;
};

Verdict judge(const Image<float>& light, const Image<float>& truth, const Image<float>& variance,
              const SensorCorrection& used, const std::vector<bool>& saturated) {
  Verdict verdict;
  std::vector<bool> left_out = saturated;
  verdict.saturated = static_cast<int>(std::ranges::count(saturated, true));
  for (const Repair& one : used.repairs)
    left_out[static_cast<std::size_t>(one.y) * light.width() + one.x] = true;
  verdict.repaired = static_cast<int>(used.repairs.size());
  constexpr double kLeast = 0.05;  // of full well
  double ratio = 0;
  std::vector<std::pair<float, float>> by_level;  // truth, error
  for (int y0 = 0; y0 + 32 <= light.height(); y0 += 16)
    for (int x0 = 0; x0 + 32 <= light.width(); x0 += 16) {
      double error = 0, sum = 0;
      int count = 0;
      for (int y = y0; y < y0 + 32; ++y)
        for (int x = x0; x < x0 + 32; ++x) {
          if (truth.at(x, y) < kLeast || saturated[static_cast<std::size_t>(y) * light.width() + x])
            continue;
          error += light.at(x, y) - truth.at(x, y);
          sum += truth.at(x, y);
          ++count;
        }
      if (count >= 1000)
        verdict.worst_tile_bias = std::max(verdict.worst_tile_bias, std::abs(error / sum));
    }
  for (std::size_t k = 0; k < left_out.size(); ++k) {
    if (left_out[k]) continue;
    const float t = truth.texels()[k], error = light.texels()[k] - t;
    ratio += static_cast<double>(error) * error / variance.texels()[k];
    ++verdict.pixels;
    if (t >= kLeast) by_level.emplace_back(t, error);
  }
  verdict.error_ratio = std::sqrt(ratio / verdict.pixels);
  std::ranges::sort(by_level);
  for (std::size_t k = 0; k + 1000 <= by_level.size(); k += 1000) {
    double error = 0, sum = 0;
    for (std::size_t i = k; i < k + 1000; ++i) {
      error += by_level[i].second;
      sum += by_level[i].first;
    }
    if (std::abs(error / sum) > verdict.worst_level_bias) {
      verdict.worst_level_bias = std::abs(error / sum);
      verdict.worst_level = sum / 1000;
    }
  }
  return verdict;
}

// Each lamp is a light state of its own; one fades while the other brightens.
TEST(ClosedLoop, RawFramesUnderTwoLampsThatDriftApartGiveTheLightBack) {
  Lab lab;
  struct State {
    const char* name;
    Lamps lamps;
    double drift;  // a frame
  };
  for (const State& state : {State{"key", {1, 0}, -0.004}, State{"fill", {0, 1}, 0.003}}) {
    const Flat flat = lab.flatOf(state.lamps);
    SensorCorrection used;
    const Image<float> light = lab.meanRadiance(state.lamps, state.drift, flat, used);
    const Averaged averaged{kFrames, kMasterFrames, kMasterFrames, flat.master.report.levels};
    const Image<float> variance =
        varianceOfLight(light.view(), used, {1, 1, 1}, lab.noise(), averaged);
    const Verdict verdict =
        judge(light, lab.truth(state.lamps, flat), variance, used, lab.saturated());
    std::printf(
        "%s: error %.3f of the predicted, bias %.3f %% (worst 32x32 tile), %.3f %% (worst "
        "1,000 pixels of one level, at %.3f), %d pixels, %d repaired, %d saturated\n",
        state.name, verdict.error_ratio, 100 * verdict.worst_tile_bias,
        100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels, verdict.repaired,
        verdict.saturated);
    EXPECT_LE(verdict.error_ratio, 1.1);
    EXPECT_GT(verdict.error_ratio, 0.9);
    EXPECT_LE(verdict.worst_tile_bias, 0.002);
    EXPECT_LE(verdict.worst_level_bias, 0.002);
    EXPECT_GT(verdict.repaired, 0);
    EXPECT_GT(verdict.pixels, 150'000);
  }
}

// The same of cameras that give 8 bits, through responses measured from their brackets.
TEST(ClosedLoop, EightBitsThroughAMeasuredResponseGiveTheLightBackForEveryToneCurve) {
  Lab lab;
  for (const testing::Tone& tone : testing::kTones) {
    lab.giveCodes(tone);
    const Lamps lamps{1, 0};
    const Flat flat = lab.flatOf(lamps);
    SensorCorrection used;
    const Image<float> light = lab.meanRadiance(lamps, -0.004, flat, used);
    const Averaged averaged{kFrames, kMasterFrames, kMasterFrames, flat.master.report.levels};
    const Image<float> variance =
        varianceOfLight(light.view(), used, {1, 1, 1}, lab.noise(), averaged, lab.response());
    const Verdict verdict = judge(light, lab.truth(lamps, flat), variance, used, lab.saturated());
    std::printf(
        "8 bits, %s: error %.3f of the predicted, bias %.3f %% (worst 32x32 tile), %.3f %% (worst "
        "1,000 pixels of one level, at %.3f), %d pixels, %d repaired, %d saturated\n",
        tone.name, verdict.error_ratio, 100 * verdict.worst_tile_bias,
        100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels, verdict.repaired,
        verdict.saturated);
    EXPECT_LE(verdict.error_ratio, 1.1) << tone.name;
    EXPECT_GT(verdict.error_ratio, 0.9) << tone.name;
    EXPECT_LE(verdict.worst_tile_bias, 0.002) << tone.name;
    EXPECT_LE(verdict.worst_level_bias, 0.002) << tone.name;
    EXPECT_GT(verdict.pixels, 150'000) << tone.name;
  }
}

}  // namespace
}  // namespace patina::calibration
