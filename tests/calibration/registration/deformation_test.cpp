// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/failure.h"
#include "calibration/registration/registration.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;

struct Errors {
  double before = 0, rms = 0, worst = 0;
};

// Against the twin's grids, 12 px from the edges and off the grey patch, which does not warp.
Errors errorsOf(const Deformation& found, TwinView& view, Nanoseconds before, Nanoseconds after) {
  const auto from = view.onSpecimenAt(before), to = view.onSpecimenAt(after);
  const RectPx card = view.patchWithBorder();
  Errors out;
  double squares = 0, before_squares = 0;
  int count = 0;
  for (int y = 12; y < from.size.height - 12; y += 4)
    for (int x = 12; x < from.size.width - 12; x += 4) {
      if (x < card.x + card.width + 12 && y > card.y - 12) continue;
      const PlacePx at{static_cast<double>(x), static_cast<double>(y)};
      const PlacePx truth = truePlace(from, to, at), seen = found.moved(at);
      if (!std::isfinite(truth.x)) continue;
      const double off = std::hypot(seen.x - truth.x, seen.y - truth.y);
      before_squares += std::pow(truth.x - at.x, 2) + std::pow(truth.y - at.y, 2);
      squares += off * off;
      out.worst = std::max(out.worst, off);
      ++count;
    }
  out.rms = std::sqrt(squares / count);
  out.before = std::sqrt(before_squares / count);
  return out;
}

TEST(Deformation, FollowsDryingWoodToAThirdOfAPixel) {
  for (const char* specimen : {"wood_drying", "steel_rusting"}) {
    devices::Fault warp;
    warp.kind = devices::FaultKind::kSpecimenWarps;
    warp.device = devices::kTheSpecimen;
    warp.amount = 0.04;
    warp.at = 60h;
    warp.duration = 6min;  // so that it hardly ages meanwhile
    TwinView view(specimen, {256, 256}, {warp});
    Image<std::uint8_t> usable(256, 256, 1, 255);
    const RectPx card = view.patchWithBorder();
    for (int y = card.y; y < card.y + card.height; ++y)
      for (int x = card.x; x < card.x + card.width; ++x) usable.at(x, y) = 0;
    const Image<float> still = view.picture(60h), frame = view.picture(60h + 6min);
    Progress progress;
    const PreparedPicture before = preparePicture(still.view(), usable.view());
    AlignOptions affine;  // most of it
    affine.model = MotionModel::kAffine;
    const Alignment pose = align(frame.view(), before, affine, progress);
    const Deformation found = findDeformation(before, preparePicture(frame.view(), usable.view()),
                                              pose.frame_from_reference, {}, progress);
    const Errors errors = errorsOf(found, view, 60h, 60h + 6min);
    std::printf(
        "%s shrunk by 4 %%: displaced %.2f px RMS, found to %.3f px RMS, worst %.2f; zncc "
        "%.3f -> %.3f\n",
        specimen, errors.before, errors.rms, errors.worst, found.zncc_before, found.zncc_after);
    EXPECT_GT(errors.before, 1.5);
    EXPECT_LE(errors.rms, 0.3) << specimen;
    EXPECT_GT(found.zncc_after, found.zncc_before);
  }
}

TEST(Deformation, OfWhatHasOnlyMovedAddsNextToNothing) {
  const ShiftedSpecimen twin("steel_rusting", {128, 128});
  Progress progress;
  const Deformation found = findDeformation(preparePicture(twin.at(0.6, {}, 1).view()),
                                            preparePicture(twin.at(0.6, {2.5, -1.5}, 2).view()),
                                            shift(2.5, -1.5), {}, progress);
  EXPECT_LT(found.largest_px, 0.3);
  const PixelMap map = found.map();
  EXPECT_EQ(map.size(), (SizePx{128, 128}));
  EXPECT_NEAR(map.source_px.at(60, 70, 0), 62.5, 0.2);
  EXPECT_NEAR(map.source_px.at(60, 70, 1), 68.5, 0.2);
}

TEST(Deformation, RefusesOptionsThatMakeNoSense) {
  DeformationOptions options;
  options.spacing_px = 4;
  EXPECT_THROW(options.check(), CalibrationError);
  options = {};
  options.smoothness = -1;
  EXPECT_THROW(options.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
