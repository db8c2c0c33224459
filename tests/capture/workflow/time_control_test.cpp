// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/time_control.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"
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
  controlTime(control, input, options);
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
  control.lamp = mesh::Lamp{false, {0, 0, 5}};
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
  control.lamp = mesh::Lamp{true, {1, 0, 1}};
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
  EXPECT_EQ(options.rates.back().time_s, 100);
  EXPECT_EQ(options.start_s.at(15, 3), 50);
  EXPECT_EQ(options.start_s.at(5, 3), 0);
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

}  // namespace
}  // namespace patina::workflow
