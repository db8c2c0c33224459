// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/reference_chart.h"

#include <gtest/gtest.h>

#include "calibration/colour/delta_e.h"
#include "calibration/failure.h"

namespace patina::calibration {
namespace {

std::string lines(int count) {
  std::string text = "# measured\nfield,L,a,b\n";
  for (int i = 0; i < count; ++i)
    text += std::to_string(i + 1) + "," + std::to_string(90 - i) + ",1.5,-2\n";
  return text;
}

TEST(ReferenceChart, EditionsDifferByWhatTheEyeJustSees) {
  const ChartColours &old = chartColours(ChartEdition::kBefore2014),
                     &now = chartColours(ChartEdition::kSince2014);
  double mean = 0;
  for (int i = 0; i < kChartFields; ++i) mean += deltaE2000(old[i], now[i]) / kChartFields;
  EXPECT_GT(mean, 0.5);
  EXPECT_LT(mean, 1.5);
}

TEST(ReferenceChart, GoesFromWhiteToBlackInItsLastRow) {
  for (const ChartEdition edition : {ChartEdition::kBefore2014, ChartEdition::kSince2014})
    for (int i = kWhiteField; i < kBlackField; ++i)
      EXPECT_GT(chartColours(edition)[i].l, chartColours(edition)[i + 1].l + 10);
  EXPECT_EQ(fieldName(kWhiteField), "white");
  EXPECT_EQ(fieldName(kBlackField), "black");
}

TEST(ReferenceChart, ReadsMeasuredValuesWithNumbersAndHeadingsBeside) {
  const ChartColours colours = parseChartColours(lines(24));
  EXPECT_EQ(colours[0].l, 90);
  EXPECT_EQ(colours[23].l, 67);
  EXPECT_EQ(colours[7].a, 1.5);
  EXPECT_EQ(colours[7].b, -2);
}

TEST(ReferenceChart, RefusesAnotherNumberOfFieldsAndWhatIsNoColour) {
  EXPECT_THROW(parseChartColours(lines(23)), CalibrationError);
  EXPECT_THROW(parseChartColours(lines(25)), CalibrationError);
  EXPECT_THROW(parseChartColours(lines(23) + "24,120,0,0\n"), CalibrationError);
  EXPECT_THROW(parseChartColours(""), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
