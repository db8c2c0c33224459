// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_charts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/workflow/light_report.h"
#include "processing/image/random.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using namespace std::chrono_literals;
using testing::kMay;
using testing::TempFolder;

TakenLevels levels(int count, Nanoseconds every, const std::function<double(int)>& level) {
  TakenLevels taken;
  for (int i = 0; i < count; ++i) {
    const double noise = 1 + 0.001 * gaussian(hashSeed(8, static_cast<std::uint64_t>(i)));
    taken.utc.push_back(kMay + i * every);
    taken.level.push_back(0.4 * level(i) * noise);
    taken.baseline.push_back(i < 3 ? 0 : 0.4);
  }
  return taken;
}

TEST(LightCharts, FindTheStepAndWhenItWas) {
  const SeriesCharts c =
      chartSeries(levels(200, 10min, [](int i) { return i < 120 ? 1.0 : 0.985; }), kMay, {});
  ASSERT_EQ(c.told.size(), 1u);
  EXPECT_NEAR(c.told[0].step, -0.015, 0.005);
  EXPECT_EQ(c.told[0].utc, kMay + 120 * Nanoseconds(10min));
  ASSERT_EQ(c.ewma.size(), 197u);
  EXPECT_NEAR(c.ewma.front(), 1, 0.003);
  EXPECT_NEAR(c.ewma.back(), 0.985, 0.002);
}

TEST(LightCharts, FindHowALampWarmsUp) {
  const SeriesCharts c = chartSeries(
      levels(300, 5s, [](int i) { return 1 - 0.03 * std::exp(-i * 5 / 300.0); }), kMay, {});
  EXPECT_TRUE(c.told.empty());
  ASSERT_TRUE(c.warm_up.found);
  EXPECT_NEAR(toSeconds(c.warm_up.tau), 300, 30);
}

TEST(LightCharts, FindWhatTheLightFollowsOfTheTemperatureBesideIt) {
  std::vector<db::ReadingRow> readings;
  for (int i = 0; i < 300; ++i) {
    db::ReadingRow r;
    r.quantity = "temperature";
    r.quality = "ok";
    r.utc = kMay + i * Nanoseconds(10min) - Nanoseconds(1min);
    r.value = 20 + 3 * std::sin(i * 0.04);
    readings.push_back(r);
  }
  const SeriesCharts c = chartSeries(
      levels(300, 10min, [](int i) { return 1 - 0.002 * 3 * std::sin(i * 0.04); }), kMay, readings);
  ASSERT_TRUE(c.follows.contains("temperature"));
  EXPECT_NEAR(c.follows.at("temperature").slope, -0.002, 0.0002);
  EXPECT_FALSE(c.follows.contains("humidity"));
}

std::vector<db::LightCheckRow> colourRows(double red) {
  std::vector<db::LightCheckRow> rows;
  for (int step = 0; step < 4; ++step)
    for (const char* channel : {"r", "g", "b"}) {
      db::LightCheckRow r;
      r.step_id = step;
      r.light_state = "key";
      r.source = "patch:cam0";
      r.channel = channel;
      r.baseline = 0.4;
      r.ratio = r.channel == "r" && step == 2 ? red : 1;
      r.verdict = "pass";
      r.utc = kMay + step * Nanoseconds(10min);
      rows.push_back(r);
    }
  return rows;
}

TEST(LightCharts, MeasureTheColourAgainstItsBaseline) {
  const auto colours = chartColours(colourRows(1.02), kMay);
  ASSERT_EQ(colours.size(), 1u);
  ASSERT_EQ(colours[0].du_v.size(), 4u);
  EXPECT_NEAR(colours[0].du_v[0], 0, 1e-9);
  EXPECT_GT(colours[0].du_v[2], 0.0009);
  EXPECT_EQ(colours[0].du_v_max, colours[0].du_v[2]);
}

TEST(LightCharts, MeasureHowFarASweepSpreads) {
  auto rows = colourRows(1);
  EXPECT_EQ(sweepSpread(rows), 0);
  rows.push_back(rows[1]);  // green of step 0, from another exposure
  rows.back().ratio = 1.007;
  EXPECT_NEAR(sweepSpread(rows), 0.007, 1e-9);
}

TEST(LightCharts, CountTheHoursOfEveryLamp) {
  const TempFolder folder = TempFolder::inMemory();
  std::vector<testing::MadeStep> steps;
  for (int i = 0; i < 7; ++i)
    steps.push_back({{{.light = "key"}, {.light = "fill+key"}, {.light = "off"}}});
  const std::string run = testing::makeRun(folder.path(), steps);
  const db::ArchiveReader reader(folder.path());
  const auto lamps = lampUse(reader, run, {"key"});
  ASSERT_EQ(lamps.size(), 2u);
  EXPECT_EQ(lamps.at("key").shots, 14);
  EXPECT_EQ(lamps.at("fill").shots, 7);
  EXPECT_NEAR(lamps.at("key").hours, 1, 0.1);
  EXPECT_LT(lamps.at("fill").hours, 0.1);
}

TEST(LightCharts, AreDrawnAlsoOfARunWithoutAny) {
  LightReport report;
  report.run_id = "empty";
  const auto pictures = drawLightCharts(report);
  for (const char* name : {"level", "ewma", "cusum", "colour"}) {
    ASSERT_TRUE(pictures.contains(name)) << name;
    EXPECT_GT(pictures.at(name).width(), 300);
  }
}

}  // namespace
}  // namespace patina::workflow
