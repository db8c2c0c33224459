// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_fit.h"

#include <gtest/gtest.h>

#include "calibration/colour/delta_e.h"
#include "calibration/failure.h"
#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

const ChartColours& expected() { return chartColours(ChartEdition::kSince2014); }

ColourFit fit(const SeenColours& seen, const FitOptions& options = {}) {
  Progress progress;
  return fitColour(seen, expected(), options, progress);
}

// What a camera without any mixing sees, with an offset, noise and a bend.
SeenColours seenWith(double offset, double noise, double bend = 0) {
  SeenColours out;
  for (int i = 0; i < kChartFields; ++i) {
    Rgb rgb = plainCamera(xyzOf(expected()[i]));
    rgb[0] += bend * std::sqrt(rgb[0] * rgb[1]);
    for (int c = 0; c < 3; ++c) out[i][c] = rgb[c] + offset + noise * gaussian(hashSeed(7, i, c));
  }
  return out;
}

TEST(ColourFit, FindsThePlantedMatrixWhateverTheExposure) {
  for (const double exposure : {1.0, 0.02}) {
    SeenColours seen = seenWith(0, 0);
    for (Rgb& rgb : seen)
      for (double& v : rgb) v *= exposure;
    const ColourFit found = fit(seen, {.kind = FitKind::k3x3});
    EXPECT_LT(found.report.worst_after, 1e-3);
    EXPECT_GT(found.report.mean_before, 5);
  }
}

TEST(ColourFit, GoesBelowLeastSquaresInXyz) {
  const SeenColours seen = seenWith(0, 0.004, 0.2);
  for (const FitKind kind : kFitKinds) {
    const auto squares = [&](int iterations) {
      double sum = 0;
      const ColourFit found = fit(seen, {.kind = kind, .iterations_max = iterations});
      for (const FieldColours& field : found.report.fields)
        sum += field.delta_e_after * field.delta_e_after;
      return sum;
    };
    EXPECT_LT(squares(60), 0.97 * squares(0)) << nameOf(kind);
  }
}

TEST(ColourFit, KeepsWhiteExactlyWhenAskedTo) {
  const SeenColours seen = seenWith(0, 0.01, 0.1);
  for (const FitKind kind : kFitKinds) {
    const ColourFit kept = fit(seen, {.kind = kind, .preserve_white = true});
    EXPECT_LT(kept.report.fields[kWhiteField].delta_e_after, 1e-6) << nameOf(kind);
    EXPECT_GT(fit(seen, {.kind = kind}).report.fields[kWhiteField].delta_e_after, 1e-3);
  }
}

TEST(ColourFit, TakesTheFewestNumbersThatTheFieldsHoldUp) {
  const ColourFit plain = fit(seenWith(0, 0.003));
  EXPECT_EQ(plain.model.kind, FitKind::k3x3);
  ASSERT_EQ(plain.report.kinds.size(), 4u);
  // More numbers fit better and predict worse.
  EXPECT_LT(plain.report.kinds[3].mean, plain.report.kinds[0].mean);
  EXPECT_GT(plain.report.kinds[3].left_out_mean, plain.report.kinds[0].left_out_mean);
}

TEST(ColourFit, TakesTheKindThatExplainsTheCamera) {
  EXPECT_EQ(fit(seenWith(0.01, 0.0005)).model.kind, FitKind::k4x3);
  const FitKind bent = fit(seenWith(0, 0.0005, 0.5)).model.kind;
  EXPECT_TRUE(bent == FitKind::kRoot2 || bent == FitKind::kRoot3) << nameOf(bent);
}

TEST(ColourFit, ReportsWhatItsModelGives) {
  const SeenColours seen = seenWith(0.005, 0.003);
  const ColourFit found = fit(seen);
  double mean = 0;
  for (int i = 0; i < kChartFields; ++i) {
    const double off = deltaE2000(expected()[i], labOf(colourOf(found.model, seen[i])));
    EXPECT_NEAR(found.report.fields[i].delta_e_after, off, 1e-9);
    EXPECT_LE(off, found.report.worst_after);
    mean += off / kChartFields;
  }
  EXPECT_NEAR(found.report.mean_after, mean, 1e-9);
  EXPECT_EQ(found.report.fields[found.report.worst_field].delta_e_after, found.report.worst_after);
  EXPECT_LE(found.report.median_after, found.report.worst_after);
}

TEST(ColourFit, IsRefusedForFieldsWithoutLevelOrAllAlike) {
  SeenColours seen = seenWith(0, 0);
  seen[kWhiteField] = {0, 0, 0};
  EXPECT_THROW(fit(seen), CalibrationError);
  seen = seenWith(0, 0);
  seen[3][1] = NAN;
  EXPECT_THROW(fit(seen), CalibrationError);
  EXPECT_THROW((FitOptions{.iterations_max = -1}).check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
