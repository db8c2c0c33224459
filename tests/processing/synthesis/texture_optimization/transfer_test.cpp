// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/transfer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "processing/stbrdf/stbrdf_file.h"
#include "tests/processing/synthesis/texture_optimization/samples.h"
#include "tests/processing/synthesis/texture_optimization/stops_at.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::texture_optimization {
namespace {

// Rings, with grain, and one texel that is black.
Image<float> picture(int side) {
  Image<float> out(side, side, 3);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<float>(
            0.5 + 0.3 * std::sin(0.3 * std::hypot(x - 20, y - 30)) +
            0.1 * uniform(hashSeed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y))));
  for (int c = 0; c < 3; ++c) out.at(5, 5, c) = 0;
  return out;
}

TransferOptions shortly(double time) {
  TransferOptions options;
  options.enlarge.optimize.rounds = 3;
  options.time = time;
  return options;
}

Image<float> diffuseAt(const Transferred& transferred, double time) {
  const stbrdf::StbrdfSet& set = transferred.larger.set;
  return evaluate(*set.find("Diffuse"), set.basis, time, stbrdf::Clamp::kNone);
}

// Correlation of what differs from the mean over 5 x 5 texels, all channels.
double detailCorrelation(const Image<float>& a, const Image<float>& b) {
  double ab = 0, aa = 0, bb = 0;
  const auto detail = [](const Image<float>& image, int x, int y, int c) {
    double sum = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) sum += image.at(x + dx, y + dy, c);
    return image.at(x, y, c) - sum / 25;
  };
  for (int y = 2; y < a.height() - 2; ++y)
    for (int x = 2; x < a.width() - 2; ++x)
      for (int c = 0; c < 3; ++c) {
        const double u = detail(a, x, y, c), v = detail(b, x, y, c);
        ab += u * v, aa += u * u, bb += v * v;
      }
  return ab / std::sqrt(aa * bb);
}

TEST(Transfer, IsThePictureAtItsTimeAndShowsItsStructureAtEveryOther) {
  Progress progress;
  const Image<float> wanted = picture(64);
  for (const double time : {0.0, 1.0}) {
    const Transferred transferred = transfer(blobs(40), wanted.view(), shortly(time), {}, progress);
    EXPECT_EQ(transferred.larger.set.size(), (SizePx{64, 64}));
    const Image<float> then = diffuseAt(transferred, time);
    for (std::size_t i = 0; i < then.texels().size(); ++i)
      ASSERT_NEAR(then.texels()[i], wanted.texels()[i], 2e-6);
    EXPECT_GT(detailCorrelation(diffuseAt(transferred, 0.5), wanted), 0.7);
    EXPECT_GT(detailCorrelation(diffuseAt(transferred, 1 - time), wanted), 0.5);
  }
}

TEST(Transfer, ChangesWhereTheMaterialDoes) {
  Progress progress;
  const Image<float> wanted = picture(64);
  const Transferred transferred = transfer(blobs(40), wanted.view(), shortly(0), {}, progress);
  const Image<float> late = diffuseAt(transferred, 1);
  double early_sum = 0, late_sum = 0;
  for (std::size_t i = 0; i < late.texels().size(); ++i) {
    early_sum += wanted.texels()[i];
    late_sum += late.texels()[i];
  }
  EXPECT_LT(late_sum, 0.8 * early_sum);  // the blobs darken by two fifths
}

// Snow on gravel. Of its own ground's structure the snow keeps less and less; the picture keeps as
// much at least, and of the sample that is pasted there the result shows no more than snow does.
TEST(Transfer, BringsNoForeignStructureLate) {
  PATINA_TEST_DATA_OR_SKIP(folder, "");
  constexpr int kSide = 128;
  Progress progress;
  stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(folder / "snowyground_stbrdf", progress);
  for (stbrdf::TimeMap& map : set.maps)
    for (Image<float>& c : map.coefficients)
      c = copyOf<float>(std::as_const(c).view().crop({0, 0, kSide, kSide}));
  const Image<float> grey = readPicture(folder / "textures" / "gravel.png").linear;
  Image<float> gravel(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) gravel.at(x, y, c) = grey.at(x, y);
  const Transferred transferred = transfer(set, gravel.view(), shortly(0), {}, progress);
  const auto snow = [&](double time) {
    return evaluate(*set.find("Diffuse"), set.basis, time, stbrdf::Clamp::kNone);
  };
  OptimizedField plain = transferred.larger.field;
  plain.gain = {};
  for (const double time : {0.5, 0.75, 1.0}) {
    const Image<float> result = diffuseAt(transferred, time),
                       pasted = shown(snow(time).view(), plain);
    const double own = detailCorrelation(snow(time), snow(0)),
                 kept = detailCorrelation(result, gravel),
                 foreign = detailCorrelation(result, pasted);
    EXPECT_GT(kept, 0.4) << time;
    EXPECT_GT(kept, own) << time;
    EXPECT_LT(foreign, 0.25) << time;
    EXPECT_LT(foreign, kept) << time;
  }
}

TEST(MatchAt, NeverDividesByNearlyNothing) {
  stbrdf::StbrdfSet set = blobs(8);
  set.maps[0].coefficients[0] = Image<float>(8, 8, 3, 1e-7f);
  set.maps[0].coefficients[1] = Image<float>(8, 8, 3, 0.3f);
  set.maps[0].coefficients[0].at(1, 1, 0) = -0.2f;
  const Image<float> wanted(8, 8, 3, 0.5f);
  EXPECT_EQ(matchAt(0, wanted.view(), set), 1);
  const Image<float> late = evaluate(set.maps[0], set.basis, 1, stbrdf::Clamp::kNone),
                     then = evaluate(set.maps[0], set.basis, 0, stbrdf::Clamp::kNone);
  for (std::size_t i = 0; i < late.texels().size(); ++i) {
    EXPECT_NEAR(then.texels()[i], 0.5f, 1e-6);
    EXPECT_LT(late.texels()[i], 0.5f + kScaleMost * 0.3f + 1e-5f);
  }
}

TEST(MatchAt, ScalesAllCoefficientsWhereThatIsSafe) {
  stbrdf::StbrdfSet set = blobs(8);
  set.maps[0].coefficients[0] = Image<float>(8, 8, 3, 0.4f);
  set.maps[0].coefficients[1] = Image<float>(8, 8, 3, -0.2f);
  EXPECT_EQ(matchAt(0, Image<float>(8, 8, 3, 0.6f).view(), set), 0);
  EXPECT_FLOAT_EQ(set.maps[0].coefficients[0].at(3, 3, 1), 0.6f);
  EXPECT_FLOAT_EQ(set.maps[0].coefficients[1].at(3, 3, 1), -0.3f);
}

TEST(Equalised, IsTheRankOfEachValue) {
  Image<float> grey(4, 1, 1);
  grey.texels() = {5, 1, 5, 100};
  EXPECT_EQ(equalised(grey.view()).texels(), (std::vector<float>{0.5f, 0.125f, 0.5f, 0.875f}));
  grey.at(2, 0) = NAN;
  EXPECT_THROW(equalised(grey.view()), ProcessingError);
}

TEST(Transfer, LeavesNothingWhereverItIsStopped) {
  const testing::TempFolder temp;
  const stbrdf::StbrdfSet set = blobs(40);
  const Image<float> wanted = picture(48);
  const int stopped = stoppedEverywhere(temp.path(), [&](Progress& progress) {
    stbrdf::writeStbrdfSet(
        temp / "out", transfer(set, wanted.view(), shortly(0), {}, progress).larger.set, progress);
  });
  EXPECT_GT(stopped, 8);
  EXPECT_TRUE(std::filesystem::exists(temp / "out" / "Diffuse-0.exr"));
}

TEST(Transfer, RefusesATimeOutsideTheSet) {
  Progress progress;
  EXPECT_THROW(transfer(blobs(40), picture(64).view(), shortly(1.5), {}, progress),
               ProcessingError);
  EXPECT_THROW(transfer(blobs(40), picture(64).view(), shortly(NAN), {}, progress),
               ProcessingError);
}

}  // namespace
}  // namespace patina::texture_optimization
