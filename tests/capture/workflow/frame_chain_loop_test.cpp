// SPDX-License-Identifier: GPL-3.0-or-later
// From an archive's frames back to the light that the twin saw, through the chain that textures are
// built of, by calibrations made and kept as a user makes them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <numeric>
#include <utility>

#include "calibration/sensor/propagated_noise.h"
#include "calibration/sensor/radiance.h"
#include "capture/workflow/defects_calibration.h"
#include "capture/workflow/frame_chain.h"
#include "capture/workflow/light_gain.h"
#include "capture/workflow/master.h"
#include "capture/workflow/photon_transfer_calibration.h"
#include "capture/workflow/response_calibration.h"
#include "capture/workflow/view_calibration.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/random.h"
#include "tests/calibration/sensor/light_verdict.h"
#include "tests/calibration/sensor/tone_curve.h"
#include "tests/calibration/sensor/twin_shots.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using calibration::LightVerdict;
using testing::TempFolder;
using testing::TwinStudio;
using Lamps = std::array<double, 2>;  // level of key and fill

constexpr SizePx kSize{512, 384};
constexpr const char* kSizeText = "512x384";
constexpr double kExposure_s = 0.02;
constexpr Lamps kLamps{0.6, 0.5}, kDrift{-0.004, 0.003};
constexpr int kFrames = 16, kDarks = 48, kFlats = 64;

// What a camera writes: the mosaic's numbers as a DNG, or a grey picture of their 8-bit codes by a
// tone curve of its own.
enum class Numbers { kRaw, kCodes };

class Loop {
 public:
  explicit Loop(Numbers numbers) : numbers_(numbers) {
    shootRun();
    makeCalibrations();
  }
  LightVerdict judge(int channel);
  int channels() const { return numbers_ == Numbers::kRaw ? 3 : 1; }
  const std::vector<std::string>& used() const { return used_; }

 private:
  Bytes fileOf(const RawMosaic& raw) const {
    if (numbers_ == Numbers::kRaw) return encodeDng(raw);
    const Image<std::uint8_t> codes = testing::tonedCodes(raw, testing::kTones[1]);
    return encodePng(codes.view());
  }
  static RawMosaic exposed(TwinStudio& studio, Lamps lamps, std::uint64_t key,
                           double exposure_s = kExposure_s) {
    RawMosaic raw = studio.maker.expose(TwinStudio::shot(lamps[0], lamps[1], exposure_s, key));
    raw.taken_utc = testing::kMay;
    return raw;
  }
  std::filesystem::path plant(const char* name, const std::vector<Bytes>& files) {
    std::filesystem::path to = folder_ / name;
    std::filesystem::create_directories(to);
    for (std::size_t k = 0; k < files.size(); ++k)
      writeFileAtomically(
          to / ("f" + std::to_string(100 + k) + (numbers_ == Numbers::kRaw ? ".dng" : ".png")),
          files[k]);
    return to;
  }
  void shootRun();
  void makeCalibrations();
  calibration::MasterReport stack(const char* kind, Lamps lamps, int count);
  void measureResponse();
  void measurePhotons();
  void build();
  calibration::SensorCorrection correction() const;

  Numbers numbers_;
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  TwinStudio card_{"grey_card", kSizeText}, scene_{"banana_ripening", kSizeText};
  Lamps reference_{};  // level at which each lamp's light stands in the result
  std::array<double, 3> flat_levels_{};
  std::filesystem::path dark_, flat_, defects_;
  calibration::NoiseModels noise_;
  std::optional<calibration::ResponseCurve> response_;
  Image<float> got_, wanted_, expected_, touched_;
  std::vector<std::string> used_;
};

// As the gains take it: the mean of the middle half.
double middleOf(std::vector<double> values) {
  std::ranges::sort(values);
  const auto quarter = static_cast<std::ptrdiff_t>((values.size() + 1) / 4);
  return std::accumulate(values.begin() + quarter, values.end() - quarter, 0.0) /
         static_cast<double>(values.size() - 2 * static_cast<std::size_t>(quarter));
}

// Steps of three light states. Each lamp drifts by itself and flickers from shot to shot.
void Loop::shootRun() {
  std::vector<testing::MadeStep> steps;
  std::array<std::vector<double>, 2> levels;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto level = [&](std::size_t lamp, std::uint64_t taken) {
      return kLamps[lamp] * (1 + kDrift[lamp] * static_cast<double>(i)) *
             (1 + 0.001 * gaussian(hashSeed(9, i, lamp, taken)));
    };
    testing::MadeStep step;
    const auto shoot = [&](const char* light, Lamps lamps, std::uint64_t key) {
      testing::MadeShot shot;
      shot.light = light;
      shot.size = kSize;
      shot.dng = fileOf(exposed(scene_, lamps, key + i));  // any file: decoded by what it holds
      step.shots.push_back(std::move(shot));
    };
    for (std::size_t lamp = 0; lamp < 2; ++lamp) levels[lamp].push_back(level(lamp, 0));
    shoot("key", {levels[0][i], 0}, 7000);
    shoot("fill", {0, levels[1][i]}, 7100);
    shoot("fill+key", {level(0, 1), level(1, 1)}, 8000);
    steps.push_back(std::move(step));
    for (std::size_t lamp = 0; lamp < 2; ++lamp)
      reference_[lamp] += (level(lamp, 1) - level(lamp, 0)) / kFrames;
  }
  testing::makeRun(archive_, steps);
  // What flickers between a lamp's own shot and the one of both is light, not error.
  for (std::size_t lamp = 0; lamp < 2; ++lamp) reference_[lamp] += middleOf(levels[lamp]);
}

calibration::MasterReport Loop::stack(const char* kind, Lamps lamps, int count) {
  std::vector<Bytes> files;
  for (int k = 0; k < count; ++k)
    files.push_back(fileOf(
        exposed(card_, lamps, (lamps[0] > 0 ? 2000 : 1000) + static_cast<std::uint64_t>(k))));
  MasterRequest request;
  request.kind = kind;
  request.folder = plant(kind, files);
  request.camera = "cam0";
  request.exposure = fromSeconds(kExposure_s);
  request.iso = 100;
  Progress progress;
  const MasterOutcome made = makeMaster(archive_, request, testing::now(), progress);
  (lamps[0] > 0 ? flat_ : dark_) = made.path;
  return made.report;
}

void Loop::measureResponse() {
  ResponseRequest request;
  std::vector<Bytes> files;
  // The first of a covered lens; each exposure twice, for the lamp flickers.
  for (const double t : {0.0, 0.0001, 0.0002, 0.0004, 0.0007, 0.0013, 0.0021, 0.0037, 0.0067,
                         0.0113, 0.0191, 0.0301, 0.0427})
    for (std::uint64_t take = 0; take < 2; ++take) {
      const auto key = 1'000'000 * (1 + take) + static_cast<std::uint64_t>(1e6 * t);
      const double level = t > 0 ? 1 + 0.001 * gaussian(hashSeed(10, key)) : 0;
      files.push_back(fileOf(exposed(card_, {level, 0}, key, std::max(t, 1e-4))));
      request.exposures_s.push_back(t);
    }
  request.folder = plant("brackets", files);
  request.camera = "cam0";
  request.options.iterations = 20;
  Progress progress;
  response_ = makeResponse(archive_, request, testing::now(), progress).response.curve;
}

void Loop::measurePhotons() {
  const Numbers numbers = std::exchange(numbers_, Numbers::kRaw);  // of the sensor itself
  std::vector<Bytes> flats, darks;
  std::uint64_t key = 100;
  for (const double level : {0.1, 0.1, 0.3, 0.3, 0.7, 0.7, 1.2, 1.2, 2.6, 2.6})
    flats.push_back(fileOf(exposed(card_, {level, 0}, ++key)));
  for (int k = 0; k < 2; ++k) darks.push_back(fileOf(exposed(card_, {0, 0}, ++key)));
  NoiseRequest request;
  request.flats = plant("pairs", flats);
  request.darks = plant("dark_pair", darks);
  Progress progress;
  noise_ = measureNoise({}, request, testing::now(), progress).transfer.noise;
  numbers_ = numbers;
}

void Loop::makeCalibrations() {
  measurePhotons();
  if (numbers_ == Numbers::kCodes) measureResponse();
  stack("dark", {0, 0}, kDarks);
  flat_levels_ = stack("flat", kLamps, kFlats).levels;
  DefectsRequest defects;
  defects.camera = "cam0";
  defects_ = makeDefects(archive_, defects, testing::now()).kept.path;
  // The profile's lens, straight down.
  const auto& bent = devices::twin::referenceProfile().lens;
  ViewCalibration view;
  view.lens = {kSize,
               1.2 * kSize.width,
               1.2 * kSize.width,
               (kSize.width - 1) / 2.0,
               (kSize.height - 1) / 2.0,
               bent.k1,
               bent.k2,
               0,
               0,
               0};
  view.fit.view = {{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 500}};
  view.taken = testing::now();
  ViewRequest request;
  request.camera = "cam0";
  keepView(archive_, view, request, testing::now());
  const RectPx patch = scene_.maker.layout().patch_px;
  for (const char* light : {"key", "fill", "fill+key"}) {
    LightGainRequest gain;
    gain.run = "latest";
    gain.selection.light = light;
    gain.patch = {patch.x + 4, patch.y + 4, patch.width - 8, patch.height - 8};
    Progress progress;
    measureLightGain(archive_, gain, testing::now(), progress);
  }
}

calibration::SensorCorrection Loop::correction() const {
  const Image<float> dark = readPicture(dark_).linear, flat = readPicture(flat_).linear;
  const calibration::ColourFilters filters =
      numbers_ == Numbers::kRaw ? RawMosaic{}.cfa : calibration::kOneColour;
  return calibration::prepareCorrection(
      kSize, 1, filters, dark.view(), flat.view(),
      calibration::defectsThatMatter(readDefects(defects_), fromSeconds(kExposure_s), 20));
}

void Loop::build() {
  const db::ArchiveReader reader(archive_);
  const db::RunRow run = reader.runs().back();
  FrameRequest request;
  request.selection.light = "fill+key";
  request.lamps.apart = true;
  request.rectify.emplace();
  Progress progress;
  FrameChain chain(reader, run, request, progress);
  used_ = chain.calibrations();
  while (const auto frame = chain.source().next()) {
    if (got_.empty())
      got_ = Image<float>(frame->linear.width(), frame->linear.height(), channels());
    for (std::size_t k = 0; k < got_.texels().size(); ++k)
      got_.texels()[k] += frame->linear.texels()[k] / kFrames;
  }
  const PixelMap map =
      rectifyMap(reader, keyOf(chain.frames(), run.t0_utc), *request.rectify, false).map;
  const calibration::LightSteps texture = [&](ImageView<const float> mosaic) {
    if (numbers_ == Numbers::kCodes) return resample(mosaic, map);
    const Image<float> colours = demosaicLinear(mosaic, RawMosaic{}.cfa);
    return resample(colours.view(), map);
  };
  const calibration::SensorCorrection used = correction();
  Image<float> truth(kSize.width, kSize.height, 1), touched = truth;
  const std::vector<float> seen = scene_.maker.light(
                               TwinStudio::shot(reference_[0], reference_[1], kExposure_s, 1)),
                           card = card_.maker.light(
                               TwinStudio::shot(kLamps[0], kLamps[1], kExposure_s, 1));
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * kSize.width + x;
      const int colour =
          numbers_ == Numbers::kRaw ? calibration::colourAt(RawMosaic{}.cfa, x, y) : 0;
      truth.at(x, y) =
          static_cast<float>(seen[k] / card[k] * flat_levels_[static_cast<std::size_t>(colour)]);
    }
  for (const calibration::Repair& one : used.repairs) touched.at(one.x, one.y) = 1;
  wanted_ = texture(truth.view());
  touched_ = texture(touched.view());
  const calibration::Averaged averaged{kFrames, kDarks, kFlats, flat_levels_};
  const Image<float> variance = calibration::varianceOfLight(
      truth.view(), used, {1, 1, 1}, noise_, averaged, response_ ? &*response_ : nullptr);
  expected_ = calibration::varianceThrough(texture, truth.view(), variance.view());
}

LightVerdict Loop::judge(int channel) {
  if (got_.empty()) build();
  std::array<Image<float>, 3> planes;
  const std::array<const Image<float>*, 3> from{&got_, &wanted_, &expected_};
  std::vector<bool> aside;
  for (std::size_t k = 0; k < 3; ++k) {
    planes[k] = Image<float>(got_.width(), got_.height(), 1);
    for (std::size_t i = 0; i < planes[k].texels().size(); ++i)
      planes[k].texels()[i] = from[k]->texels()[i * static_cast<std::size_t>(channels()) + channel];
  }
  for (std::size_t i = 0; i < planes[0].texels().size(); ++i) {
    const std::size_t at = i * static_cast<std::size_t>(channels()) + channel;
    // Codes at their top say only that there was more.
    aside.push_back(touched_.texels()[at] != 0 || !(planes[2].texels()[i] > 0) ||
                    planes[1].texels()[i] > 0.95f);
  }
  return calibration::judge(planes[0], planes[1], planes[2], aside);
}

void expectTheLightBack(Loop& loop, const char* numbers) {
  for (int c = 0; c < loop.channels(); ++c) {
    const LightVerdict verdict = loop.judge(c);
    std::printf(
        "%s through the frame chain, channel %d: error %.3f of the predicted, bias %.3f %% (worst "
        "32x32 tile), %.3f %% (worst 1,000 texels of one level, at %.3f), %d texels\n",
        numbers, c, verdict.error_ratio, 100 * verdict.worst_tile_bias,
        100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels);
    EXPECT_LE(verdict.error_ratio, 1.1) << c;
    EXPECT_GT(verdict.error_ratio, 0.9) << c;
    EXPECT_LE(verdict.worst_tile_bias, 0.002) << c;
    EXPECT_LE(verdict.worst_level_bias, 0.002) << c;
    EXPECT_GT(verdict.pixels, 170'000) << c;
  }
}

TEST(FrameChainLoop, RawFramesUnderTwoLampsThatDriftApartGiveTheLightBack) {
  Loop loop(Numbers::kRaw);
  expectTheLightBack(loop, "raw");
  EXPECT_EQ(loop.used().size(), 4u) << "dark, flat, defects, view";
}

TEST(FrameChainLoop, EightBitsThroughTheirResponseGiveTheLightBack) {
  Loop loop(Numbers::kCodes);
  expectTheLightBack(loop, "8 bits");
  EXPECT_EQ(loop.used().size(), 5u) << "response, dark, flat, defects, view";
}

}  // namespace
}  // namespace patina::workflow
