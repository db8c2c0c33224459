// SPDX-License-Identifier: GPL-3.0-or-later
// Each trouble of a view, seen in the frames of a camera by an answer known beforehand.
#include "devices/twin/view_troubles.h"

#include <gtest/gtest.h>

#include <complex>

#include "devices/twin/camera_view.h"
#include "devices/twin/visitors.h"
#include "tests/devices/twin/troubled_frames.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

constexpr SizePx kSize{256, 256};
const char* const kPx = "256x256";

RectPx patchOf(const RigSpec& spec) { return pictureLayout(spec, spec.cameras[0]).patch_px; }

TroubledView viewAt(Nanoseconds run_time) {
  TroubledView view;
  view.camera = "cam0";
  view.size = kSize;
  view.patch_px = patchOf(benchRig("grey_card", kPx));
  view.patch_reflectance = referenceProfile().patch.reflectance;
  view.run_time = run_time;
  view.process = kTroubledRun;
  return view;
}

// Mean of each column of the picture: blur along y leaves it alone.
std::vector<double> columnsOf(const RawMosaic& raw) {
  std::vector<double> columns(256);
  for (int x = 0; x < 256; ++x)
    for (int y = 1 - (x & 1); y < 256; y += 2)  // green
      columns[static_cast<std::size_t>(x)] += raw.samples.at(x, y) - 64.0;
  return columns;
}

std::complex<double> waveOf(const std::vector<double>& columns, int cycles) {
  std::complex<double> sum;
  for (std::size_t x = 0; x < columns.size(); ++x) {
    const double at = 2 * M_PI * static_cast<double>(x) / 256;
    sum += columns[x] * (1 - std::cos(at)) * std::polar(1.0, -cycles * at);
  }
  return sum;
}

TEST(ViewTroubles, AFocusThatCreepsTakesFineDetailByItsBlur) {
  const RigSpec spec = benchRig("banana_ripening", kPx);
  const std::vector<double> dim{0.5, 0};  // no pixel is full
  for (const auto& [at, sigma] : {std::pair{25h, 2.0}, {49h, 4.0}}) {
    const auto clear = columnsOf(frameAt(spec, {}, at, dim)),
               soft = columnsOf(
                   frameAt(spec, {faultOf("cam0", FaultKind::kFocusCreep, 2.0)}, at, dim));
    double kept = 0, known = 0;
    for (int cycles = 6; cycles <= 14; ++cycles) {
      const double f = cycles / 256.0, power = std::norm(waveOf(clear, cycles));
      kept += (waveOf(soft, cycles) * std::conj(waveOf(clear, cycles))).real();
      known += power * std::exp(-2 * M_PI * M_PI * sigma * sigma * f * f);
    }
    EXPECT_NEAR(kept / known, 1, 0.05) << sigma;
  }
}

TEST(ViewTroubles, ABlurStaysAsItIsWhenItsFaultIsOver) {
  FaultPlan plan;
  plan.faults = {faultOf("cam0", FaultKind::kFocusCreep, 2.0, 1h, 24h)};
  EXPECT_EQ(focusBlurPx(plan, viewAt(1h)), 0);
  EXPECT_NEAR(focusBlurPx(plan, viewAt(13h)), 1, 1e-12);
  EXPECT_NEAR(focusBlurPx(plan, viewAt(90h)), 2, 1e-12);
  plan.faults[0].amount = 500;
  EXPECT_EQ(focusBlurPx(plan, viewAt(90h)), 32) << "an eighth of the picture";
}

TEST(ViewTroubles, FogTakesItsShareOfTheContrastAndSwellsAndClears) {
  const RigSpec spec = benchRig("grey_card", kPx);
  const Fault fog = faultOf("cam0", FaultKind::kCondensation, 0.4, 10h, 20h);
  const std::vector<float> falloff = lensFalloff(kSize, referenceProfile().lens);
  const RectPx patch = patchOf(spec), bare{160, 40, 32, 32},
               inner{patch.x + 16, patch.y + 16, 32, 32};
  const auto contrast = [&](const std::vector<Fault>& faults, Nanoseconds at) {
    const RawMosaic raw = frameAt(spec, faults, at);
    const auto level = [&](const RectPx& r) {
      double share = 0;
      for (int y = r.y; y < r.y + r.height; ++y)
        for (int x = r.x; x < r.x + r.width; ++x)
          share += falloff[static_cast<std::size_t>(y) * 256 + x];
      return meanOf(raw, r) * r.width * r.height / share;
    };
    return level(bare) - level(inner);
  };
  EXPECT_NEAR(contrast({fog}, 20h) / contrast({}, 20h), 0.6, 0.01);
  EXPECT_NEAR(contrast({fog}, 11h) / contrast({}, 11h), 0.8, 0.01) << "half of the first tenth";
  EXPECT_NEAR(contrast({fog}, 29h) / contrast({}, 29h), 0.8, 0.01) << "half of the last tenth";
  EXPECT_NEAR(contrast({fog}, 31h) / contrast({}, 31h), 1, 0.005);
}

TEST(ViewTroubles, AHandIsInThePictureWhileItLastsAndDarkInTheDark) {
  const RigSpec spec = benchRig("grey_card", kPx);
  const Fault hand = faultOf("cam0", FaultKind::kHand, 0, 2h, 30min);
  FaultPlan plan;
  plan.faults = {hand};
  const std::vector<float> share = handShare(kSize, viewKey(plan, hand));
  const RawMosaic with = frameAt(spec, {hand}, 2h + 10min), without = frameAt(spec, {}, 2h + 10min);
  double red = 0, blue = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      const float covered = share[static_cast<std::size_t>(y) * 256 + x];
      const double value = with.samples.at(x, y) - 64.0;
      if (covered == 0) {
        ASSERT_EQ(with.samples.at(x, y), without.samples.at(x, y));
      }
      if (covered == 1 && (x & 1) + (y & 1) == 0) red += value;
      if (covered == 1 && (x & 1) + (y & 1) == 2) blue += value;
    }
  EXPECT_GT(red, 2 * blue) << "skin";
  EXPECT_GT(red / 256 / 256, 10);
  EXPECT_EQ(frameAt(spec, {hand}, 2h + 10min, {0, 0}).samples.texels(),
            frameAt(spec, {}, 2h + 10min, {0, 0}).samples.texels());
  EXPECT_EQ(frameAt(spec, {hand}, 3h).samples.texels(), frameAt(spec, {}, 3h).samples.texels());
}

TEST(ViewTroubles, AnInsectDarkensWhereItsPathSaysAndWalksOn) {
  const RigSpec spec = benchRig("grey_card", kPx);
  const Fault insect = faultOf("cam0", FaultKind::kInsect, 0, 10h, 10h);
  FaultPlan plan;
  plan.faults = {insect};
  for (const auto at : {14h, 15h, 16h}) {
    const RawMosaic with = frameAt(spec, {insect}, at), without = frameAt(spec, {}, at);
    double sum = 0, sum_x = 0, sum_y = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const double lost =
            1 - (with.samples.at(x, y) - 64.0) / std::max(without.samples.at(x, y) - 64.0, 1.0);
        if (lost < 0.2) continue;
        sum += lost;
        sum_x += lost * (x + 0.5);
        sum_y += lost * (y + 0.5);
      }
    const InsectPlace place =
        insectAt(kSize, viewKey(plan, insect), toSeconds(at - 10h) / toSeconds(Nanoseconds(10h)));
    ASSERT_GT(sum, 20) << at.count();
    EXPECT_NEAR(sum_x / sum, place.x_px, 2) << at.count();
    EXPECT_NEAR(sum_y / sum, place.y_px, 2) << at.count();
  }
}

struct CoverCase {
  FaultKind kind;
  bool darker;
};
class PatchCover : public ::testing::TestWithParam<CoverCase> {};

TEST_P(PatchCover, CoversItsShareOfThePatchAndNothingElse) {
  const RigSpec spec = benchRig("banana_ripening", kPx);
  const RectPx patch = patchOf(spec);
  const RawMosaic with = frameAt(spec, {faultOf("cam0", GetParam().kind, 0.3)}, 50h),
                  without = frameAt(spec, {}, 50h);
  int covered = 0;
  double green = 0, red = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      const bool on_patch =
          x >= patch.x && x < patch.x + patch.width && y >= patch.y && y < patch.y + patch.height;
      if (!on_patch) {
        ASSERT_EQ(with.samples.at(x, y), without.samples.at(x, y)) << x << " " << y;
        continue;
      }
      const double ratio = (with.samples.at(x, y) - 64.0) / (without.samples.at(x, y) - 64.0);
      if (std::abs(ratio - 1) < 0.2) continue;
      ++covered;
      EXPECT_EQ(ratio < 1, GetParam().darker);
      if ((x & 1) + (y & 1) == 0) red += ratio;
      if ((x & 1) + (y & 1) == 1) green += ratio / 2;
    }
  EXPECT_NEAR(covered / (64.0 * 64.0), 0.3, 0.005);
  if (GetParam().kind == FaultKind::kPatchOvergrown) {
    EXPECT_GT(green, 1.5 * red);
  }
  if (GetParam().kind == FaultKind::kPatchSoiled) {
    EXPECT_LT(green, red);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, PatchCover,
                         ::testing::Values(CoverCase{FaultKind::kPatchSoiled, true},
                                           CoverCase{FaultKind::kPatchSnowed, false},
                                           CoverCase{FaultKind::kPatchOvergrown, true}),
                         [](const auto& c) { return std::string(name(c.param.kind)); });

TEST(ViewTroubles, SnowComesOverATenthOfItsTimeAndCoversMoreOfTheSame) {
  FaultPlan plan;
  plan.faults = {faultOf("cam0", FaultKind::kPatchSnowed, 0.5, 10h, 20h)};
  const auto little = patchReflectance(plan, viewAt(11h)),
             much = patchReflectance(plan, viewAt(15h));
  int before = 0, after = 0;
  for (std::size_t k = 0; k < little.size(); ++k) {
    before += little[k] > 0.5f;
    after += much[k] > 0.5f;
    if (little[k] > 0.5f) {
      ASSERT_GT(much[k], 0.5f);
    }
  }
  EXPECT_NEAR(before / (64.0 * 64.0), 0.25, 0.005);
  EXPECT_NEAR(after / (64.0 * 64.0), 0.5, 0.005);
}

TEST(ViewTroubles, HappenToTheirOwnCameraOnly) {
  const RigSpec spec = benchRig("grey_card", "64x48");
  std::vector<Fault> elsewhere;
  for (const FaultKind kind : {FaultKind::kFocusCreep, FaultKind::kCondensation, FaultKind::kHand,
                               FaultKind::kInsect, FaultKind::kPatchSoiled})
    elsewhere.push_back(faultOf("cam1", kind, 0.5));
  EXPECT_EQ(frameAt(spec, elsewhere, 50h).samples.texels(),
            frameAt(spec, {}, 50h).samples.texels());
}

}  // namespace
}  // namespace patina::devices::twin
