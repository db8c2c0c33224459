// SPDX-License-Identifier: GPL-3.0-or-later
// Boards of known squares in a picture: chessboards and ChArUco boards (Garrido-Jurado et al.,
// 2014).
#pragma once

#include <optional>
#include <string>

#include "calibration/lens/lens.h"

namespace patina::calibration {

struct BoardSpec {
  enum Kind { kChessboard, kCharuco };
  Kind kind = kChessboard;
  // Chessboard: inner corners, as OpenCV counts them: one less than squares each way. ChArUco:
  // squares.
  int columns = 9, rows = 6;
  double square_mm = 1;
  double marker_mm = 0;  // ChArUco, below square_mm; markers are of dictionary 4x4_50 ... 4x4_1000
  void check() const;    // CalibrationError(kUsage), with the range
};
std::string describe(const BoardSpec& board);  // "9x6 inner corners", "ChArUco of 7x5 squares"

// One picture's corners. Places on the board are in mm from the board's middle, x along its
// columns, y along its rows, z = 0; which end is first may differ by half a turn where the board
// looks the same either way.
struct BoardSight {
  std::vector<PointMm> board_mm;
  std::vector<PlacePx> seen_px;  // to a fraction of a pixel
  double spacing_px = 0;         // of neighbouring corners, mean
};

// What finders work on: linear light, [h][w][1], scaled so that all but the brightest hundredth of
// the picture lies below 0.9; clipped at 1.
Image<float> greyOf(ImageView<const float> linear);

// Nothing where the board is not seen: a chessboard must be seen whole, of a ChArUco board at least
// six corners. Corners are refined on linear light behind a blur of 1 px, in a window of a third of
// a square (cornerSubPix): on sharp boards that is closer than on the picture as coded.
// What the quick finder misses is tried with the thorough one (findChessboardCornersSB). A grid
// that is bent by more than a sixth of a square is none. Thread-safe. 10 ms to 0.3 s a megapixel.
std::optional<BoardSight> findBoard(ImageView<const float> grey, const BoardSpec& board);

// Another count of inner corners that these pictures show, when most of the first three do: a board
// of another size than told. With `larger` only those that hold more than the told one, as is asked
// when the told one was found: part of a larger board looks like a smaller board. Up to 0.1 s a
// size tried.
std::optional<BoardSpec> boardShown(std::span<const Image<float>> greys, const BoardSpec& told,
                                    bool larger);

}  // namespace patina::calibration
