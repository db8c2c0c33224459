// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/board.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "processing/image/cv_bridge.h"
#include "processing/image/encoding.h"

namespace patina::calibration {
namespace {

using cv::Point2f;

constexpr int kCornersLeast = 6;       // of a ChArUco board
constexpr double kBentMost = 1.0 / 6;  // of a square, RMS off a plane seen without distortion
constexpr int kProbeWidthPx = 640, kProbePictures = 3, kProbeReach = 2;
constexpr int kReachMostPx = 8;                   // beyond it the lens bends the edges
constexpr double kBlurPx = 1, kWindow = 1.0 / 3;  // of the refinement; the window in squares

int innerColumns(const BoardSpec& board) {
  return board.kind == BoardSpec::kCharuco ? board.columns - 1 : board.columns;
}
int innerRows(const BoardSpec& board) {
  return board.kind == BoardSpec::kCharuco ? board.rows - 1 : board.rows;
}

// Of corner `index`, counted along the columns, row by row.
PointMm placeOn(const BoardSpec& board, int index) {
  const int columns = innerColumns(board), x = index % columns, y = index / columns;
  return {(x - (columns - 1) / 2.0) * board.square_mm,
          (y - (innerRows(board) - 1) / 2.0) * board.square_mm, 0};
}

BoardSight sightOf(const BoardSpec& board, const std::vector<Point2f>& corners,
                   const std::vector<int>& ids) {
  BoardSight sight;
  double sum = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sight.board_mm.push_back(placeOn(board, ids[i]));
    sight.seen_px.push_back({corners[i].x, corners[i].y});
    if (i == 0 || ids[i] != ids[i - 1] + 1 || ids[i] % innerColumns(board) == 0) continue;
    sum += cv::norm(corners[i] - corners[i - 1]);
    ++pairs;
  }
  sight.spacing_px = pairs > 0 ? sum / pairs : 0;
  return sight;
}

// RMS distance from the nearest plane seen without distortion, in squares.
double bend(const BoardSight& sight) {
  std::vector<cv::Point2d> from, to, through;
  for (const PointMm& p : sight.board_mm) from.emplace_back(p.x, p.y);
  for (const PlacePx& p : sight.seen_px) to.emplace_back(p.x, p.y);
  const cv::Mat homography = cv::findHomography(from, to);
  if (homography.empty() || !(sight.spacing_px > 0)) return 1;
  cv::perspectiveTransform(from, through, homography);
  return cv::norm(through, to) / std::sqrt(static_cast<double>(to.size())) / sight.spacing_px;
}

double spacingOf(const std::vector<Point2f>& corners, int columns) {
  double least = 1e9;
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (i % columns != 0) least = std::min(least, cv::norm(corners[i] - corners[i - 1]));
  return least;
}

// To about a pixel; false when the grid is not there.
bool findCoarsely(const cv::Mat& grey, const BoardSpec& board, std::vector<Point2f>& corners) {
  return cv::findChessboardCorners(grey, {board.columns, board.rows}, corners,
                                   cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
}

BoardSight wholeSight(const BoardSpec& board, const std::vector<Point2f>& corners) {
  std::vector<int> ids(corners.size());
  std::iota(ids.begin(), ids.end(), 0);
  return sightOf(board, corners, ids);
}

void refine(const cv::Mat& grey, double reach_px, std::vector<Point2f>& corners) {
  cv::Mat soft;
  const int reach = std::clamp(static_cast<int>(reach_px), 2, kReachMostPx);
  cv::GaussianBlur(grey, soft, {}, std::min(kBlurPx, reach / 4.0));
  cv::cornerSubPix(soft, corners, {reach, reach}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
}

cv::Mat coded(const cv::Mat& grey) {  // as for the eye, 8 bits
  cv::Mat linear = grey;
  Image<std::uint8_t> srgb = encodeSrgb8(viewOf<float>(linear));
  return asMat(srgb.view()).clone();
}

std::optional<BoardSight> findChessboard(const cv::Mat& grey, const BoardSpec& board) {
  const cv::Mat eye = coded(grey);
  std::vector<Point2f> corners;
  if (!findCoarsely(eye, board, corners) &&
      !cv::findChessboardCornersSB(eye, {board.columns, board.rows}, corners,
                                   cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
    return std::nullopt;
  refine(grey, spacingOf(corners, board.columns) * kWindow, corners);
  BoardSight sight = wholeSight(board, corners);
  if (!(bend(sight) < kBentMost)) return std::nullopt;
  return sight;
}

bool shownByMost(const std::vector<cv::Mat>& pictures, const BoardSpec& board) {
  std::size_t shown = 0, left = pictures.size();
  for (const cv::Mat& picture : pictures) {
    std::vector<Point2f> corners;
    if (findCoarsely(picture, board, corners) && bend(wholeSight(board, corners)) < kBentMost)
      ++shown;
    --left;
    if (2 * (shown + left) <= pictures.size()) return false;
  }
  return 2 * shown > pictures.size();
}

cv::Ptr<cv::aruco::Dictionary> dictionaryFor(const BoardSpec& board) {
  const int markers = board.columns * board.rows / 2;
  using namespace cv::aruco;
  return getPredefinedDictionary(markers <= 50    ? DICT_4X4_50
                                 : markers <= 100 ? DICT_4X4_100
                                 : markers <= 250 ? DICT_4X4_250
                                                  : DICT_4X4_1000);
}

std::optional<BoardSight> findCharuco(const cv::Mat& grey, const BoardSpec& board) {
  const auto dictionary = dictionaryFor(board);
  const auto charuco = cv::aruco::CharucoBoard::create(
      board.columns, board.rows, static_cast<float>(board.square_mm),
      static_cast<float>(board.marker_mm), dictionary);
  std::vector<std::vector<Point2f>> markers;
  std::vector<int> marker_ids, ids;
  std::vector<Point2f> corners;
  const auto parameters = cv::aruco::DetectorParameters::create();
  const cv::Mat eye = coded(grey);
  cv::aruco::detectMarkers(eye, dictionary, markers, marker_ids, parameters);
  if (marker_ids.empty()) return std::nullopt;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, eye, charuco, corners, ids);
  if (static_cast<int>(ids.size()) < kCornersLeast) return std::nullopt;
  // The window ends before the markers, whose corners would pull.
  const double gap = (board.square_mm - board.marker_mm) / 2 / board.square_mm;
  refine(grey, sightOf(board, corners, ids).spacing_px * gap - 1, corners);
  BoardSight sight = sightOf(board, corners, ids);
  if (!(bend(sight) < kBentMost)) return std::nullopt;
  return sight;
}

}  // namespace

void BoardSpec::check() const {
  if (columns < 3 || rows < 3 || columns > 100 || rows > 100)
    throw CalibrationError(Exit::kUsage, "a board of " + std::to_string(columns) + "x" +
                                             std::to_string(rows) + ": 3 to 100 each way");
  if (!(square_mm > 0 && square_mm <= 10'000))
    throw CalibrationError(Exit::kUsage,
                           "the squares of a board are above 0 and at most 10 m wide");
  if (kind != kCharuco) return;
  if (!(marker_mm > 0 && marker_mm < square_mm))
    throw CalibrationError(Exit::kUsage,
                           "the markers of a ChArUco board are narrower than its squares");
  if (columns * rows / 2 > 1000)
    throw CalibrationError(Exit::kUsage, "a ChArUco board has at most 1000 markers");
}

std::string describe(const BoardSpec& board) {
  const std::string size = std::to_string(board.columns) + "x" + std::to_string(board.rows);
  return board.kind == BoardSpec::kCharuco ? "ChArUco of " + size + " squares"
                                           : size + " inner corners";
}

Image<float> greyOf(ImageView<const float> linear) {
  Image<float> grey(linear.width, linear.height, 1);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x)
      grey.at(x, y) = linear.channels < 3
                          ? linear.at(x, y)
                          : 0.2126f * linear.at(x, y, 0) + 0.7152f * linear.at(x, y, 1) +
                                0.0722f * linear.at(x, y, 2);
  std::vector<float> sorted = grey.texels();
  const auto bright = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 99 / 100);
  std::nth_element(sorted.begin(), bright, sorted.end());
  const float white = *bright;
  if (white > 0)
    for (float& v : grey.texels()) v = std::clamp(v / white * 0.9f, 0.0f, 1.0f);
  return grey;
}

std::optional<BoardSight> findBoard(ImageView<const float> grey, const BoardSpec& board) {
  board.check();
  PATINA_CHECK(grey.channels == 1);
  const cv::Mat picture = asMat(grey);
  return board.kind == BoardSpec::kCharuco ? findCharuco(picture, board)
                                           : findChessboard(picture, board);
}

std::optional<BoardSpec> boardShown(std::span<const Image<float>> greys, const BoardSpec& told,
                                    bool larger) {
  if (told.kind == BoardSpec::kCharuco) return std::nullopt;
  std::vector<cv::Mat> small;
  for (const Image<float>& grey :
       greys.first(std::min<std::size_t>(greys.size(), kProbePictures))) {
    cv::Mat mat = coded(asMat(grey.view()));
    const double scale = static_cast<double>(kProbeWidthPx) / mat.cols;
    if (scale < 1) cv::resize(mat, mat, {}, scale, scale, cv::INTER_AREA);
    small.push_back(std::move(mat));
  }
  std::optional<BoardSpec> best;
  // Wide ones first: a board is the same both ways round.
  for (int columns = told.columns + kProbeReach; columns >= std::max(3, told.columns - kProbeReach);
       --columns)
    for (int rows = std::max(3, told.rows - kProbeReach); rows <= told.rows + kProbeReach; ++rows) {
      if (columns == told.columns && rows == told.rows) continue;
      if (larger && (columns < told.columns || rows < told.rows)) continue;
      if (best && columns * rows <= best->columns * best->rows) continue;
      BoardSpec other = told;
      other.columns = columns;
      other.rows = rows;
      if (shownByMost(small, other)) best = other;
    }
  return best;
}

}  // namespace patina::calibration
