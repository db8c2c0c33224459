// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/chart.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/sha256.h"
#include "processing/render/palette.h"
#include "tests/processing/render/probe.h"

namespace patina::render {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr Colour kRed{255, 0, 0}, kBlue{0, 0, 255};

Chart flatLine(double y) {
  Chart chart;
  chart.size = {600, 300};
  chart.y_low = 0;
  chart.y_high = 2;
  chart.lines = {{.name = "", .colour = kRed, .x = {0, 1, 2}, .y = {y, y, y}, .width_px = 3}};
  return chart;
}

double meanRowOf(const Image<std::uint8_t>& image, Colour colour) {
  double sum = 0;
  int n = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (isNear(image, x, y, colour)) sum += y, ++n;
  return n > 0 ? sum / n : NAN;
}

TEST(DrawChart, PlacesValuesWhereTheyBelong) {
  const double low = meanRowOf(drawChart(flatLine(0.5)), kRed);
  const double middle = meanRowOf(drawChart(flatLine(1.0)), kRed);
  const double high = meanRowOf(drawChart(flatLine(1.5)), kRed);
  EXPECT_LT(high, middle);
  EXPECT_NEAR(middle - high, low - middle, 1.0);
}

TEST(DrawChart, BreaksALineAtNan) {
  Chart whole = flatLine(1), broken = flatLine(1);
  whole.lines[0].x = broken.lines[0].x = {0, 1, 2, 3, 4};
  whole.lines[0].y = {1, 1, 1, 1, 1};
  broken.lines[0].y = {1, 1, NAN, 1, 1};
  const int all = countNear(drawChart(whole), kRed), part = countNear(drawChart(broken), kRed);
  EXPECT_NEAR(part / static_cast<double>(all), 0.5, 0.05);
}

TEST(DrawChart, KeepsASingleOutlierAmongManyPoints) {
  Chart chart = flatLine(1);
  auto& line = chart.lines[0];
  line.x.clear();
  line.y.clear();
  for (int i = 0; i < 120'000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 61'234 ? 0.1 : 1.0);
  }
  const auto image = drawChart(chart);
  int lowest = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (image.at(x, y, 0) > 200 && image.at(x, y, 1) < 120 && image.at(x, y, 2) < 120) lowest = y;
  EXPECT_GT(lowest, 220);
}

TEST(DrawChart, ShowsSpansBandsAndMarkers) {
  Chart chart = flatLine(1);
  chart.spans = {{"missed", kBlue, 0.5, 0.6}};
  chart.bands = {{"tolerance", {0, 200, 0}, 0.2, 0.4}};
  chart.points = {{.name = "fail", .colour = {200, 0, 200}, .x = {1.5}, .y = {1.5}, .size_px = 9}};
  const auto image = drawChart(chart);
  EXPECT_GT(countNear(image, kBlue), 1000);
  EXPECT_GT(countNear(image, {0, 200, 0}), 3000);
  EXPECT_GT(countNear(image, {200, 0, 200}), 60);
}

TEST(DrawChart, StandsEmptyNanAndConstantValues) {
  Chart chart;
  chart.size = {400, 200};
  EXPECT_THAT(chartSvg(chart), HasSubstr("no data"));
  chart.lines = {{.name = "a", .colour = kRed, .x = {NAN, 1}, .y = {1, INFINITY}}};
  EXPECT_THAT(chartSvg(chart), HasSubstr("no data"));
  chart.lines = {{.name = "a", .colour = kRed, .x = {5}, .y = {0}}};
  EXPECT_THAT(chartSvg(chart), Not(HasSubstr("no data")));
  EXPECT_GT(countNear(drawChart(chart), kRed), 3);
}

TEST(DrawChart, RefusesUnequalLengthsAndTinySizes) {
  Chart chart = flatLine(1);
  chart.lines[0].y.pop_back();
  EXPECT_THROW(drawChart(chart), ProcessingError);
  chart = flatLine(1);
  chart.size = {20, 20};
  EXPECT_THROW(chartSvg(chart), ProcessingError);
}

TEST(DrawChart, NamesEverySeriesOnceInItsLegend) {
  Chart chart = flatLine(1);
  chart.title = "Light <of> a week";
  chart.lines[0].name = "lamp a";
  chart.lines.push_back(chart.lines[0]);
  const std::string svg = chartSvg(chart);
  EXPECT_THAT(svg, HasSubstr("Light &lt;of&gt; a week"));
  EXPECT_EQ(svg.find("lamp a"), svg.rfind("lamp a"));
}

TEST(DrawChart, IsTheSameEveryTime) {
  EXPECT_EQ(drawChart(flatLine(1)).texels(), drawChart(flatLine(1)).texels());
}

}  // namespace
}  // namespace patina::render
