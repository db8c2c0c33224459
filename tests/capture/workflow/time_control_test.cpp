// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/time_control.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "capture/workflow/failure.h"
#include "devices/twin/specimen.h"
#include "processing/image/picture_file.h"
#include "processing/mesh/shapes.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

ttf::TtfInfo texture(int width, int height) {
  ttf::TtfInfo info;
  info.frames = 11;
  info.width = width;
  info.height = height;
  info.mm_per_texel = 0.5;
  for (int t = 0; t < 11; ++t) info.time_s.push_back(100 + 10.0 * t);
  return info;
}

ttf::RetimeOptions controlled(const TimeControl& control, const ttf::TtfInfo& input) {
  ttf::RetimeOptions options;
  Progress progress;
  controlTime(control, input, options, progress);
  return options;
}

TimeControl formula(const std::string& rate) {
  TimeControl control;
  control.rate = rate;
  return control;
}

TEST(TimeControl, PutsTheMiddleAtZeroWithYUpAndHalfTheSmallerSideAtOne) {
  const auto options = controlled(formula("10 + x + 2*y"), texture(40, 20));
  ASSERT_EQ(options.rates.size(), 1u);
  EXPECT_NEAR(options.rates[0].rate.at(39, 0), 10 + 1.95 + 2 * 0.95, 1e-5);
  EXPECT_NEAR(options.rates[0].rate.at(0, 19), 10 - 1.95 - 2 * 0.95, 1e-5);
}

TEST(TimeControl, TakesAPictureAsDisplayedAndOfAnySize) {
  const TempFolder folder = TempFolder::inMemory();
  Image<std::uint8_t> half(4, 2, 1, 128);
  const Bytes png = encodePng(std::as_const(half).view());
  testing::writeFile(folder / "m.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  TimeControl control;
  control.map = folder / "m.png";
  const auto options = controlled(control, texture(40, 20));
  EXPECT_EQ(options.rates[0].rate.size(), (SizePx{40, 20}));
  EXPECT_NEAR(options.rates[0].rate.at(17, 9), 128 / 255.0, 1e-3);
}

TEST(TimeControl, LightsAFlatTextureByEquation9WithTheBrightestAtOne) {
  TimeControl control = formula("light");
  control.lamp = MovingLamp::parse("0,0,5", false);
  const auto options = controlled(control, texture(41, 41));
  const Image<float>& rate = options.rates[0].rate;
  EXPECT_NEAR(rate.at(20, 20), 1, 1e-6);
  const double r2 = 25 + 100;  // mm^2, at the edge
  EXPECT_NEAR(rate.at(40, 20), std::pow(5 / std::sqrt(r2) / r2 * 25, 2), 1e-5);
}

TEST(TimeControl, SlowsTheShadowOfASurfaceDown) {
  const TempFolder folder = TempFolder::inMemory();
  Image<float> wall(60, 20, 1);
  for (int y = 0; y < 20; ++y) wall.at(30, y) = 5;
  writeExr(folder / "h.exr", std::as_const(wall).view());
  TimeControl control = formula("0.25 + 0.75*shadow");
  control.height = folder / "h.exr";
  control.lamp = MovingLamp::parse("1,0,1", true);
  const auto options = controlled(control, texture(60, 20));
  EXPECT_FLOAT_EQ(options.rates[0].rate.at(27, 10), 0.25f);
  EXPECT_FLOAT_EQ(options.rates[0].rate.at(40, 10), 1);
  EXPECT_FLOAT_EQ(options.rates[0].rate.at(10, 10), 1);
}

TEST(TimeControl, MakesSeveralMapsOfARateThatChangesAndOneOfStarts) {
  TimeControl control = formula("1 + t");
  control.start = "x > 0 ? 0.5 : 0";
  const auto options = controlled(control, texture(20, 20));
  ASSERT_GT(options.rates.size(), 2u);
  EXPECT_EQ(options.rates.front().rate.at(3, 3), 1);
  EXPECT_EQ(options.rates.back().rate.at(3, 3), 2);
  // The mean rate is 3/4 of the greatest: 13.3 steps, so that the fourteenth shows the end.
  EXPECT_DOUBLE_EQ(options.rates.back().time_s, 140);
  EXPECT_DOUBLE_EQ(options.duration_s.value_or(0), 140);
  EXPECT_EQ(options.start_s.at(15, 3), 50);
  EXPECT_EQ(options.start_s.at(5, 3), 0);
}

// Over the middle at noon: the brightest texel at the brightest time has 1.
TEST(TimeControl, FollowsASunThatRisesAndSets) {
  TimeControl control = formula("light");
  control.lamp = MovingLamp::parse("cos(pi*t), 0, sin(pi*t)", true);
  const auto options = controlled(control, texture(20, 20));
  ASSERT_EQ(options.rates.size(), 33u);
  for (int k = 0; k < 33; ++k)
    EXPECT_NEAR(options.rates[k].rate.at(4, 4), std::pow(std::sin(M_PI * k / 32), 2), 1e-6) << k;
}

TEST(TimeControl, MovesTheShadowOfWhatStandsOnTheTexture) {
  TimeControl control = formula("0.1 + 0.9*shadow");
  control.casters.push_back(std::make_shared<mesh::TriangleMesh>(
      placed(mesh::sphereMesh(2, 24), {mesh::V3f(0), {0, 0, 2}, 1})));
  control.lamp = MovingLamp::parse("t < 0.5 ? 1 : -1, 0, 1", true);
  const auto options = controlled(control, texture(60, 20));  // 0.5 mm a texel
  const Image<float>&morning = options.rates.front().rate, &evening = options.rates.back().rate;
  EXPECT_FLOAT_EQ(morning.at(25, 10), 0.1f);  // 2.25 mm left of the middle
  EXPECT_FLOAT_EQ(morning.at(35, 10), 1);
  EXPECT_FLOAT_EQ(evening.at(25, 10), 1);
  EXPECT_FLOAT_EQ(evening.at(35, 10), 0.1f);
}

TEST(TimeControl, RunsThroughTheTextureCoordinatesOfAMesh) {
  TimeControl control = formula("0.5 + 0.5*light");
  control.mesh = std::make_shared<mesh::TriangleMesh>(mesh::sphereMesh(10, 32));
  control.lamp = MovingLamp::parse("0,0,1", true);
  const auto options = controlled(control, texture(64, 64));
  const Image<float>& rate = options.rates[0].rate;
  EXPECT_NEAR(rate.at(20, 1), 1, 0.01);      // the pole
  EXPECT_NEAR(rate.at(20, 16), 0.75, 0.03);  // 45 degrees down: cos^2 is a half
  EXPECT_FLOAT_EQ(rate.at(20, 50), 0.5f);    // the far side
  control.rate = "curvature";
  EXPECT_NEAR(controlled(control, texture(64, 64)).rates[0].rate.at(20, 30), 0.1, 0.002);
}

TEST(TimeControl, RefusesRatesBelowZeroWithTheirPlace) {
  try {
    controlled(formula("x"), texture(20, 20));
    FAIL();
  } catch (const WorkflowError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("texel 0,0"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("max(0"));
  }
  EXPECT_THROW(controlled(formula("0/0"), texture(20, 20)), WorkflowError);
  EXPECT_THROW(MovingLamp::parse("1,2", true), WorkflowError);
  EXPECT_THROW(MovingLamp::parse("1,2,x", true), ProcessingError);
}

TEST(TimeControl, SaysWhatAVariableNeeds) {
  const auto message = [](const TimeControl& control, double mm_per_texel) -> std::string {
    ttf::TtfInfo info = texture(20, 20);
    info.mm_per_texel = mm_per_texel;
    try {
      controlled(control, info);
    } catch (const WorkflowError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(formula("map"), 1), ::testing::HasSubstr("--map"));
  EXPECT_THAT(message(formula("light"), 1), ::testing::HasSubstr("--lamp"));
  EXPECT_THAT(message(formula("slope"), 0), ::testing::HasSubstr("--mm-per-texel"));
  EXPECT_THAT(message({}, 1), ::testing::HasSubstr("--rate"));
}

// A specimen's colours over its whole process, as a texture of 41 frames, a minute apart.
class Specimens : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr int kFrames = 41, kSide = 40;
  static constexpr double kStep_s = 60, kSlowest = 0.25;

  Specimens() {
    const auto specimen = devices::twin::makeSpecimen(GetParam(), 3);
    ttf::TtfInfo info;
    info.width = info.height = kSide;
    info.channels = 3;
    info.type = ttf::SampleType::kF32;
    info.mm_per_texel = specimen->info().width_mm / kSide;
    info.provenance_json = "{}";
    ttf::TtfWriter writer(in_, info);
    for (int t = 0; t < kFrames; ++t)
      writer.add(specimen->surfaceAt(t / (kFrames - 1.0), {kSide, kSide}).diffuse.view(),
                 kStep_s * t, Sha256{});
    writer.close();
  }

  Image<float> retime(const std::string& rate, std::optional<double> duration_s) {
    const ttf::TtfReader input(in_);
    ttf::RetimeOptions options;
    options.duration_s = duration_s;
    Progress progress;
    controlTime(formula(rate), input.info(), options, progress);
    ttf::retimeTtf(input, options, out_, "{}", progress);
    return options.rates[0].rate;
  }
  // Seconds at which the green of every texel has first made half of the way from the first frame
  // of `in_` to its last; NaN where that is less than a twentieth.
  std::vector<double> halfTimes(const std::filesystem::path& file) const {
    const ttf::TtfReader source(in_), reader(file);
    const Image<float> first = source.linearFrame(0), last = source.linearFrame(kFrames - 1);
    std::vector<double> out(kSide * kSide, NAN), before_v(kSide * kSide), before_s(kSide * kSide);
    for (int t = 0; t < reader.info().frames; ++t) {
      const Image<float> frame = reader.linearFrame(t);
      const double now_s = reader.info().time_s[static_cast<std::size_t>(t)];
      for (int i = 0; i < kSide * kSide; ++i) {
        const int x = i % kSide, y = i / kSide;
        const double change = last.at(x, y, 1) - first.at(x, y, 1);
        if (std::abs(change) < 0.05) continue;
        const double share = (frame.at(x, y, 1) - first.at(x, y, 1)) / change;
        if (std::isnan(out[i]) && share >= 0.5)
          out[i] =
              before_s[i] + (now_s - before_s[i]) * (0.5 - before_v[i]) / (share - before_v[i]);
        before_v[i] = share;
        before_s[i] = now_s;
      }
    }
    return out;
  }

  testing::TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path in_ = folder_ / "in.h5", out_ = folder_ / "out.h5";
};

TEST_P(Specimens, MakeHalfOfTheirChangeAtTheirSourcesTimeOverTheRate) {
  const Image<float> rate =
      retime("0.25 + 0.75*exp(-3*(x*x + y*y))", kStep_s * (kFrames - 1) / kSlowest);
  const float fastest = *std::max_element(rate.texels().begin(), rate.texels().end());
  const std::vector<double> source = halfTimes(in_), result = halfTimes(out_);
  int compared = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    if (std::isnan(source[i])) continue;
    const double want = source[i] / (rate.at(i % kSide, i / kSide) / fastest);
    ASSERT_NEAR(result[i], want, kStep_s) << i;
    ++compared;
  }
  EXPECT_GT(compared, kSide * kSide / 4);
}

TEST_P(Specimens, AtRateOneAreThePlainResultBitForBit) {
  for (const char* rate : {"1", "0.3"}) {  // the fastest ages as captured
    retime(rate, std::nullopt);
    const ttf::TtfReader source(in_), result(out_);
    ASSERT_EQ(source.info().time_s, result.info().time_s);
    for (int t = 0; t < kFrames; ++t)
      ASSERT_EQ(source.linearFrame(t).texels(), result.linearFrame(t).texels());
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Specimens,
                         ::testing::Values("grass_growth", "snow_accumulation", "paint_cracking"));

}  // namespace
}  // namespace patina::workflow
