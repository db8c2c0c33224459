// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/lens_fit.h"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "processing/image/picture_file.h"
#include "tests/calibration/lens/twin_boards.h"
#include "tests/support/places.h"

namespace patina::calibration {
namespace {

using testing::chessboard, testing::placed;

std::vector<BoardSight> sightsOfChessboards(const std::filesystem::path& folder,
                                            const std::string& side) {
  std::vector<BoardSight> sights;
  for (const int number : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14}) {
    const std::string name = side + (number < 10 ? "0" : "") + std::to_string(number) + ".jpg";
    const auto sight = findBoard(greyOf(readPicture(folder / name).linear.view()).view(),
                                 {BoardSpec::kChessboard, 9, 6, 1, 0});
    EXPECT_TRUE(sight) << name;
    if (sight) sights.push_back(*sight);
  }
  return sights;
}

// A perfect camera's sight of a 9x6 board, turned by angles in radians.
BoardSight idealSight(const Lens& lens, const cv::Vec3d& turn, const cv::Vec3d& at,
                      double noise_px = 0) {
  BoardSight sight;
  std::vector<cv::Point3d> board;
  for (int i = 0; i < 54; ++i) {
    const int column = i % 9, row = i / 9;
    sight.board_mm.push_back({5.0 * (column - 4), 5.0 * (row - 2.5), 0});
    board.emplace_back(sight.board_mm.back().x, sight.board_mm.back().y, 0);
  }
  std::vector<cv::Point2d> seen;
  cv::projectPoints(board, turn, at, cv::Matx33d(matrixOf(lens).data()), distortionOf(lens), seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double wave = noise_px * std::sin(37.0 * static_cast<double>(i) + seen[i].x);
    sight.seen_px.push_back({seen[i].x + wave, seen[i].y - wave});
  }
  return sight;
}

class Chessboards : public ::testing::TestWithParam<std::tuple<std::string, double, double>> {};
INSTANTIATE_TEST_SUITE_P(OfOpenCv, Chessboards,
                         ::testing::Values(std::tuple{"left", 0.45, 1},
                                           std::tuple{"right", 0.50, 2}),
                         [](const auto& p) { return std::get<0>(p.param); });

TEST_P(Chessboards, GiveOpenCvsOwnNumbersAndTheFocalLengthsOfItsStereoPair) {
  PATINA_TEST_DATA_OR_SKIP(folder, "chessboards");
  const auto& [side, rms_most, number] = GetParam();
  const std::vector<BoardSight> sights = sightsOfChessboards(folder, side);
  Progress progress;
  const LensFit fit = fitLens(sights, {640, 480}, {}, progress);

  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::vector<cv::Point2f>> seen;
  for (const BoardSight& sight : sights) {
    boards.emplace_back();
    seen.emplace_back();
    for (std::size_t i = 0; i < sight.seen_px.size(); ++i) {
      boards.back().emplace_back(static_cast<float>(sight.board_mm[i].x),
                                 static_cast<float>(sight.board_mm[i].y), 0.0f);
      seen.back().emplace_back(static_cast<float>(sight.seen_px[i].x),
                               static_cast<float>(sight.seen_px[i].y));
    }
  }
  cv::Mat matrix, distortion;
  std::vector<cv::Mat> rotations, translations;
  const double rms =
      cv::calibrateCamera(boards, seen, {640, 480}, matrix, distortion, rotations, translations);
  const auto found = matrixOf(fit.lens);
  const auto bent = distortionOf(fit.lens);
  double apart = std::abs(fit.report.rms_px - rms);
  for (int i = 0; i < 9; ++i)
    apart = std::max(
        apart, std::abs(found[static_cast<std::size_t>(i)] - matrix.at<double>(i / 3, i % 3)));
  for (int i = 0; i < 5; ++i)
    apart = std::max(apart, std::abs(bent[static_cast<std::size_t>(i)] - distortion.at<double>(i)));
  EXPECT_LE(apart, 1e-6);
  EXPECT_LE(fit.report.rms_px, rms_most);

  cv::FileStorage file((folder / "intrinsics.yml").string(), cv::FileStorage::READ);
  cv::Mat given;
  file["M" + std::to_string(static_cast<int>(number))] >> given;
  EXPECT_NEAR(fit.lens.fx / given.at<double>(0, 0), 1, 0.02);
  EXPECT_NEAR(fit.lens.fy / given.at<double>(1, 1), 1, 0.02);
  std::printf("%s: rms %.4f px, from OpenCV %.1e, fx %.3f fy %.3f of %.3f, covered %.2f\n",
              side.c_str(), fit.report.rms_px, apart, fit.lens.fx, fit.lens.fy,
              given.at<double>(0, 0), fit.report.covered);
}

TEST(LensFit, RecoversTheTwinsLensToATenthOfAPixelAllOverThePicture) {
  constexpr SizePx kSize{480, 360};
  const auto pose = testing::overhead(220, 1.2);
  std::vector<BoardSight> sights;
  // In the corners, where a lens bends most, and in the middle: x, y, z, turns about x, y, z.
  const double places[][6] = {
      {42, 31, 14, 0, -15, 0},    {-42, 31, 14, 0, 15, 0},   {42, -31, 14, 12, -12, 0},
      {40, 30, 16, 12, 8, 0},     {-40, 30, 16, 12, -6, 0},  {0, 4, 14, 24, 0, 0},
      {-20, -10, 20, -22, 14, 0}, {-42, -31, 14, 0, 15, 0},  {-40, -30, 16, -12, -8, 0},
      {40, -30, 16, -12, 6, 0},   {-42, -30, 15, 14, 10, 0}, {42, 30, 15, -14, -10, 0},
      {20, 10, 20, 22, -14, 0},   {0, -4, 14, -24, 0, 90},   {0, 0, 16, 0, 26, 90}};
  for (const auto& p : places) {
    const auto target = placed(chessboard(14, 10, 6), {p[0], p[1], p[2]}, {p[3], p[4], p[5]});
    const auto sight = findBoard(greyOf(testing::shootTwin(kSize, pose, {target}).view()).view(),
                                 {BoardSpec::kChessboard, 13, 9, 6, 0});
    if (sight) sights.push_back(*sight);
  }
  ASSERT_GE(sights.size(), 12u);
  LensOptions options;
  options.radial_terms = 2;
  options.tangential = false;
  Progress progress;
  const LensFit fit = fitLens(sights, kSize, options, progress);
  const Lens truth = testing::trueLens(kSize, pose);
  std::printf(
      "%zu sights, covered %.2f radius %.2f rms %.4f: fx %.3f of %.3f (sd %.3f), k1 %.4f k2 %.4f, "
      "apart %.3f px\n",
      sights.size(), fit.report.covered, fit.report.covered_radius, fit.report.rms_px, fit.lens.fx,
      truth.fx, fit.report.sd.fx, fit.lens.k1, fit.lens.k2,
      testing::straightenedApart(fit.lens, truth));
  EXPECT_LE(testing::straightenedApart(fit.lens, truth), 0.1);
  EXPECT_NEAR(fit.lens.fx / truth.fx, 1, 0.002);
}

class Ideal : public ::testing::Test {
 protected:
  LensFit fit(const std::vector<BoardSight>& sights, const LensOptions& options = {}) {
    Progress progress;
    return fitLens(sights, lens_.size, options, progress);
  }
  std::string refusal(const std::vector<BoardSight>& sights) {
    try {
      fit(sights);
    } catch (const CalibrationError& e) {
      return e.what();
    }
    return "none";
  }
  const Lens lens_{{640, 480}, 700, 705, 318, 243, -0.2, 0.05, 1e-3, -5e-4, 0};
};

TEST_F(Ideal, CornersGiveTheLensBackAndSayHowFarTheyReach) {
  const LensFit found =
      fit({idealSight(lens_, {0.4, 0, 0}, {0, 0, 90}), idealSight(lens_, {0, 0.4, 0}, {9, 5, 80}),
           idealSight(lens_, {-0.3, 0.2, 0.5}, {-9, -3, 85}),
           idealSight(lens_, {0.1, -0.4, 1.5}, {2, 4, 95})});
  EXPECT_NEAR(found.lens.fx, lens_.fx, 0.05);
  EXPECT_NEAR(found.lens.cy, lens_.cy, 0.05);
  EXPECT_NEAR(found.lens.p2, lens_.p2, 1e-5);
  EXPECT_NEAR(found.report.views[1].tilt_deg, 0.4 * 180 / M_PI, 0.05);
  EXPECT_NEAR(found.report.views[1].distance_mm, 80, 0.05);
  EXPECT_EQ(found.report.corners, 216);
  EXPECT_GT(found.report.covered, 0.4);
  EXPECT_LT(found.report.covered, 1);
}

TEST_F(Ideal, UncertaintyGrowsWithTheNoiseOfTheCorners) {
  const auto sd = [&](double noise_px) {
    return fit({idealSight(lens_, {0.4, 0, 0}, {0, 0, 90}, noise_px),
                idealSight(lens_, {0, 0.4, 0}, {9, 5, 80}, noise_px),
                idealSight(lens_, {-0.3, 0.2, 0.5}, {-9, -3, 85}, noise_px)})
        .report.sd.fx;
  };
  EXPECT_NEAR(sd(0.2) / sd(0.1), 2, 0.2);
}

TEST_F(Ideal, TermsLeftOutAreZeroAndPixelsMayBeSquare) {
  LensOptions options;
  options.radial_terms = 1;
  options.tangential = false;
  options.square_pixels = true;
  const LensFit found =
      fit({idealSight(lens_, {0.4, 0, 0}, {0, 0, 90}), idealSight(lens_, {0, 0.4, 0}, {9, 5, 80}),
           idealSight(lens_, {-0.3, 0.2, 0.5}, {-9, -3, 85})},
          options);
  EXPECT_EQ(found.lens.k2, 0);
  EXPECT_EQ(found.lens.p1, 0);
  EXPECT_EQ(found.lens.fx, found.lens.fy);
  EXPECT_GT(found.report.sd.fx, 0);
}

TEST_F(Ideal, BoardsThatAreAllParallelAreRefused) {
  EXPECT_THAT(refusal({idealSight(lens_, {0, 0, 0}, {0, 0, 90}, 0.05),
                       idealSight(lens_, {0, 0, 0.7}, {9, 5, 80}, 0.05),
                       idealSight(lens_, {0, 0, 0}, {-9, -3, 120}, 0.05)}),
              ::testing::HasSubstr("tilted by 20 to 40 degrees"));
  EXPECT_THAT(refusal({idealSight(lens_, {0.3, 0, 0}, {0, 0, 90}, 0.05),
                       idealSight(lens_, {0.3, 0, 0}, {9, 5, 80}, 0.05),
                       idealSight(lens_, {0.3, 0, 0}, {-9, -3, 120}, 0.05)}),
              ::testing::HasSubstr("focal length"));
}

TEST_F(Ideal, FewerThanThreeSightsAreRefused) {
  EXPECT_THAT(refusal({idealSight(lens_, {0.4, 0, 0}, {0, 0, 90}),
                       idealSight(lens_, {0, 0.4, 0}, {9, 5, 80})}),
              ::testing::HasSubstr("at least 3 pictures; it was found in 2"));
}

}  // namespace
}  // namespace patina::calibration
