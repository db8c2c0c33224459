// SPDX-License-Identifier: GPL-3.0-or-later
// From the twin's numbers back to the light it saw, with calibrations taken from its own pictures:
// photon transfer, dark, flat, defects, and a gain a lamp by the reference patch.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "calibration/lens/lens.h"
#include "calibration/sensor/propagated_noise.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/pixel_map.h"
#include "tests/calibration/sensor/closed_loop_lab.h"

namespace patina::calibration {
namespace {

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
    const LightVerdict verdict =
        judge(light, lab.truth(state.lamps, flat), variance, leftOut(used, lab.saturated()));
    std::printf(
        "%s: error %.3f of the predicted, bias %.3f %% (worst 32x32 tile), %.3f %% (worst "
        "1,000 pixels of one level, at %.3f), %d pixels, %zu repaired\n",
        state.name, verdict.error_ratio, 100 * verdict.worst_tile_bias,
        100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels, used.repairs.size());
    EXPECT_LE(verdict.error_ratio, 1.1);
    EXPECT_GT(verdict.error_ratio, 0.9);
    EXPECT_LE(verdict.worst_tile_bias, 0.002);
    EXPECT_LE(verdict.worst_level_bias, 0.002);
    EXPECT_FALSE(used.repairs.empty());
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
    const LightVerdict verdict =
        judge(light, lab.truth(lamps, flat), variance, leftOut(used, lab.saturated()));
    std::printf(
        "8 bits, %s: error %.3f of the predicted, bias %.3f %% (worst 32x32 tile), %.3f %% (worst "
        "1,000 pixels of one level, at %.3f), %d pixels\n",
        tone.name, verdict.error_ratio, 100 * verdict.worst_tile_bias,
        100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels);
    EXPECT_LE(verdict.error_ratio, 1.1) << tone.name;
    EXPECT_GT(verdict.error_ratio, 0.9) << tone.name;
    EXPECT_LE(verdict.worst_tile_bias, 0.002) << tone.name;
    EXPECT_LE(verdict.worst_level_bias, 0.002) << tone.name;
    EXPECT_GT(verdict.pixels, 150'000) << tone.name;
  }
}

// As a lens without distortion would see it; the profile's lens.
PixelMap straightened(SizePx size) {
  const auto& bent = devices::twin::referenceProfile().lens;
  const double focal = 1.2 * size.width;
  const Lens lens{
      size, focal, focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0, bent.k1, bent.k2,
      0,    0,     0};
  std::vector<PlacePx> places;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      places.push_back({static_cast<double>(x), static_cast<double>(y)});
  const std::vector<PlacePx> seen = distorted(lens, places);
  PixelMap map{Image<float>(size.width, size.height, 2)};
  for (std::size_t k = 0; k < seen.size(); ++k) {
    map.source_px.texels()[2 * k] = static_cast<float>(seen[k].x);
    map.source_px.texels()[2 * k + 1] = static_cast<float>(seen[k].y);
  }
  return map;
}
Image<float> channelOf(const Image<float>& in, int channel) {
  Image<float> out(in.width(), in.height(), 1);
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x) out.at(x, y) = in.at(x, y, channel);
  return out;
}

// Everything at once: two lamps that drift apart in one frame, hot pixels, fall-off, colours
// interpolated, the lens straightened by one resampling; from raw numbers and from 8-bit codes.
TEST(ClosedLoop, TexturesUnderTwoLampsThatDriftApartGiveTheLightBackThroughAllOfTheChain) {
  Lab lab;
  const Lamps lamps{0.6, 0.5};
  for (const char* numbers : {"raw", "8 bits"}) {
    if (*numbers == '8') lab.giveCodes(testing::kTones[1]);
    const Flat flat = lab.flatOf(lamps);
    SensorCorrection used;
    const Image<float> light = lab.meanUnderBoth(lamps, {-0.004, 0.003}, flat, used);
    const Averaged averaged{kFrames, kMasterFrames, kMasterFrames, flat.master.report.levels};
    const Image<float> variance =
        varianceOfLight(light.view(), used, {1, 1, 1}, lab.noise(), averaged, lab.response());
    const PixelMap map = straightened(light.size());
    const LightSteps texture = [&](ImageView<const float> mosaic) {
      return resample(demosaicLinear(mosaic, Lab::cfa()).view(), map);
    };
    const Image<float> got = texture(light.view()), wanted = texture(lab.truth(lamps, flat).view()),
                       expected = varianceThrough(texture, light.view(), variance.view());
    Image<float> touched(light.width(), light.height(), 1);
    const std::vector<bool> left_out = leftOut(used, lab.saturated());
    for (std::size_t k = 0; k < left_out.size(); ++k) touched.texels()[k] = left_out[k] ? 1.0f : 0;
    const Image<float> spread = texture(touched.view());
    for (int c = 0; c < 3; ++c) {
      std::vector<bool> aside;
      for (std::size_t k = 0; k < left_out.size(); ++k)
        aside.push_back(std::abs(spread.texels()[3 * k + c]) > 0 ||
                        expected.texels()[3 * k + c] == 0);
      const LightVerdict verdict =
          judge(channelOf(got, c), channelOf(wanted, c), channelOf(expected, c), aside);
      std::printf(
          "%s, all of the chain, channel %d: error %.3f of the predicted, bias %.3f %% (worst "
          "32x32 tile), %.3f %% (worst 1,000 texels of one level, at %.3f), %d texels\n",
          numbers, c, verdict.error_ratio, 100 * verdict.worst_tile_bias,
          100 * verdict.worst_level_bias, verdict.worst_level, verdict.pixels);
      EXPECT_LE(verdict.error_ratio, 1.1) << numbers << c;
      EXPECT_GT(verdict.error_ratio, 0.9) << numbers << c;
      EXPECT_LE(verdict.worst_tile_bias, 0.002) << numbers << c;
      EXPECT_LE(verdict.worst_level_bias, 0.002) << numbers << c;
      EXPECT_GT(verdict.pixels, 150'000) << numbers << c;
    }
  }
}

}  // namespace
}  // namespace patina::calibration
