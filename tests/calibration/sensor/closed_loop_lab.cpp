// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/calibration/sensor/closed_loop_lab.h"

#include <cmath>
#include <utility>

#include "calibration/lamps/lamp_gains.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

constexpr const char* kSize = "512x384";
constexpr double kExposure_s = 0.02;
const std::vector<double> kBrackets_s{0,      0.0001, 0.0002, 0.0004, 0.0007, 0.0013, 0.0021,
                                      0.0037, 0.0067, 0.0113, 0.0191, 0.0301, 0.0427};

}  // namespace

Lab::Lab() : card_("grey_card", kSize), scene_("banana_ripening", kSize) {
  Progress progress;
  noise_ = measurePhotonTransfer(pairs({{0, 0}, {0, 0}}, 1),
                                 pairs({{0.1, 0}, {0.3, 0}, {0.7, 0}, {1.2, 0}, {2.6, 0}}, 100), {},
                                 progress)
               .noise;
  dark_ = stackDark(stack({0, 0}, 1000), progress);
}

void Lab::giveCodes(const testing::Tone& tone) {
  Progress progress;
  tone_ = tone;
  response_.reset();
  std::vector<Bracket> brackets;
  for (const double t : kBrackets_s) {
    const auto key = 1'000'000 + static_cast<std::uint64_t>(1e6 * t);
    const double level = t > 0 ? 1 + 0.001 * gaussian(hashSeed(10, key)) : 0;
    brackets.push_back(
        {testing::tonedCodes(exposed(card_, TwinStudio::shot(level, 0, std::max(t, 1e-4), key)),
                             tone),
         t});
  }
  response_ = measureResponse(brackets, {.iterations = 20}, progress).curve;
  dark_ = stackDark(stack({0, 0}, 1000), progress);
}

Flat Lab::flatOf(Lamps lamps) {
  Progress progress;
  Flat flat{stackFlat(stack(lamps, 2000), std::as_const(dark_.image).view(), progress, cfa()),
            card_.maker.light(shot(lamps, 1))};
  return flat;
}

Image<float> Lab::meanRadiance(Lamps lamps, double drift, const Flat& flat,
                               SensorCorrection& used) {
  used = correctionBy(flat);
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

Image<float> Lab::meanUnderBoth(Lamps lamps, Lamps drift, const Flat& flat,
                                SensorCorrection& used) {
  used = correctionBy(flat);
  const auto alone = [&](std::size_t lamp, double level) {
    return lamp == 0 ? Lamps{level, 0.0} : Lamps{0.0, level};
  };
  Lamps baseline{};
  for (std::size_t lamp = 0; lamp < 2; ++lamp)
    for (std::uint64_t i = 0; i < kFrames; ++i)
      baseline[lamp] +=
          patchMean(exposed(scene_, shot(alone(lamp, lamps[lamp]), 6000 + 100 * lamp + i)), used) /
          kFrames;
  Image<float> mean(size().width, size().height, 1), light = mean;
  std::array<Image<float>, 2> shots{light, light};
  saturated_.assign(mean.texels().size(), false);
  Image<std::uint8_t> marks(size().width, size().height, 1);
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto level = [&](std::size_t lamp, std::uint64_t taken) {
      return lamps[lamp] * (1 + drift[lamp] * static_cast<double>(i)) *
             (1 + 0.001 * gaussian(hashSeed(9, i, lamp, taken)));
    };
    std::array<calibration::ChannelGains, 2> gains{};
    for (std::size_t lamp = 0; lamp < 2; ++lamp) {
      const RawMosaic& raw =
          exposed(scene_, shot(alone(lamp, level(lamp, 0)), 7000 + 100 * lamp + i));
      const auto gain = static_cast<float>(patchMean(raw, used) / baseline[lamp]);
      gains[lamp] = {gain, gain, gain};
      correct(raw, used, 1, shots[lamp], {});
    }
    correct(exposed(scene_, shot({level(0, 1), level(1, 1)}, 8000 + i)), used, 1, light,
            marks.view());
    const std::array<ImageView<const float>, 2> views{std::as_const(shots[0]).view(),
                                                      std::as_const(shots[1]).view()};
    undoDriftByShots(light.view(), views, gains);
    for (std::size_t k = 0; k < mean.texels().size(); ++k) {
      mean.texels()[k] += light.texels()[k] / kFrames;
      if ((marks.texels()[k] & kSaturated) != 0) saturated_[k] = true;
    }
  }
  return mean;
}

Image<float> Lab::truth(Lamps lamps, const Flat& flat) {
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

devices::twin::ShotLight Lab::shot(Lamps lamps, std::uint64_t key) {
  return TwinStudio::shot(lamps[0], lamps[1], kExposure_s, key);
}

PairSource Lab::pairs(std::vector<Lamps> levels, std::uint64_t key) {
  return [this, levels = std::move(levels), key,
          next = std::size_t{0}]() mutable -> std::optional<RawPair> {
    if (next == levels.size()) return std::nullopt;
    const Lamps lamps = levels[next++];
    return RawPair{card_.maker.expose(shot(lamps, key + 2 * next)),
                   card_.maker.expose(shot(lamps, key + 2 * next + 1))};
  };
}

std::function<PictureSource()> Lab::stack(Lamps lamps, std::uint64_t key) {
  return [this, lamps, key]() -> PictureSource {
    return [this, lamps, key, next = 0]() mutable -> std::optional<Image<float>> {
      if (next == kMasterFrames) return std::nullopt;
      const RawMosaic& raw = exposed(card_, shot(lamps, key + static_cast<std::uint64_t>(next++)));
      Image<float> light(raw.samples.width(), raw.samples.height(), 1);
      correct(raw, prepareCorrection(raw.samples.size(), 1, raw.cfa, {}, {}, {}), 1, light, {});
      return light;
    };
  };
}

void Lab::correct(const RawMosaic& raw, const SensorCorrection& correction, float gain,
                  Image<float>& light, ImageView<std::uint8_t> marks) const {
  if (!response_) return toRadiance(raw, correction, {gain, gain, gain}, light.view(), marks);
  const Image<std::uint8_t> codes = testing::tonedCodes(raw, tone_);
  light = linearBy(*response_, codes.view());
  correctLinear(light.view(), correction, {gain, gain, gain});
  for (int y = 0; y < marks.height; ++y)
    for (int x = 0; x < marks.width; ++x) marks.at(x, y) = codes.at(x, y) == 255;
}

const RawMosaic& Lab::exposed(TwinStudio& studio, const devices::twin::ShotLight& shot) {
  const auto [at, is_new] =
      exposed_.try_emplace({&studio, shot.levels[0], shot.levels[1], shot.noise_key});
  if (is_new) at->second = studio.maker.expose(shot);
  return at->second;
}

SensorCorrection Lab::correctionBy(const Flat& flat) {
  const DarkOf dark{std::as_const(dark_.image).view(), fromSeconds(kExposure_s), 20};
  const ImageView<const float> seen = std::as_const(flat.master.image).view();
  const FoundDefects found = findDefects(dark, seen, cfa(), {});
  return prepareCorrection(size(), 1, cfa(), dark.dark, seen,
                           defectsThatMatter(found.map, dark.exposure, 20));
}

double Lab::patchMean(const RawMosaic& raw, const SensorCorrection& correction) {
  Image<float> light(size().width, size().height, 1);
  correct(raw, correction, 1, light, {});
  const RectPx p = scene_.maker.layout().patch_px;
  double sum = 0;
  for (int y = p.y + 8; y < p.y + p.height - 8; ++y)
    for (int x = p.x + 8; x < p.x + p.width - 8; ++x) sum += light.at(x, y);
  return sum;
}

std::vector<bool> leftOut(const SensorCorrection& used, const std::vector<bool>& saturated) {
  std::vector<bool> left_out = saturated;
  for (const Repair& one : used.repairs)
    left_out[static_cast<std::size_t>(one.y) * used.size.width + one.x] = true;
  return left_out;
}

}  // namespace patina::calibration
