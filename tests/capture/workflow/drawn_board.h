// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a chessboard as a plain pinhole sees it: cheap, and known to the texel.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>

#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"

namespace patina::testing {

struct DrawnBoard {
  int columns = 8, rows = 6;         // squares of 1
  std::array<double, 3> turn_rad{};  // about x, then y, then z
  double away = 14;                  // along the view, in squares
  double x = 0, y = 0;               // aside, in squares
  double focal_px = 400;
  double falloff = 0;  // share of light missing at the corners, with the radius squared
  SizePx size{320, 240};
};

// [h][w][1] linear: white 0.7, black 0.03, around it 0.7; soft edges.
inline Image<float> drawBoard(const DrawnBoard& b) {
  const auto [a, e, g] = b.turn_rad;
  const double ca = std::cos(a), sa = std::sin(a), ce = std::cos(e), se = std::sin(e),
               cg = std::cos(g), sg = std::sin(g);
  // Columns of Rz Ry Rx: where the board's own x and y go.
  const double xx = cg * ce, xy = sg * ce, xz = -se;
  const double yx = cg * se * sa - sg * ca, yy = sg * se * sa + cg * ca, yz = ce * sa;
  const double zx = xy * yz - xz * yy, zy = xz * yx - xx * yz, zz = xx * yy - xy * yx;
  Image<float> out(b.size.width, b.size.height, 1);
  constexpr int kFine = 3;
  for (int v = 0; v < b.size.height; ++v)
    for (int u = 0; u < b.size.width; ++u) {
      double sum = 0;
      for (int i = 0; i < kFine * kFine; ++i) {
        const int column = i % kFine, row = i / kFine;
        const double dx = (u + (column + 0.5) / kFine - b.size.width / 2.0) / b.focal_px;
        const double dy = (v + (row + 0.5) / kFine - b.size.height / 2.0) / b.focal_px;
        const double along = (b.x * zx + b.y * zy + b.away * zz) / (dx * zx + dy * zy + zz);
        const double px = along * dx - b.x, py = along * dy - b.y, pz = along - b.away;
        const double at_x = px * xx + py * xy + pz * xz + b.columns / 2.0,
                     at_y = px * yx + py * yy + pz * yz + b.rows / 2.0;
        const bool inside = at_x >= 0 && at_y >= 0 && at_x < b.columns && at_y < b.rows;
        const bool black = inside && (static_cast<int>(at_x) + static_cast<int>(at_y)) % 2 == 0;
        sum += black ? 0.03 : 0.7;
      }
      const double rx = u + 0.5 - b.size.width / 2.0, ry = v + 0.5 - b.size.height / 2.0;
      const double r2 = (rx * rx + ry * ry) * 4 /
                        (static_cast<double>(b.size.width) * b.size.width +
                         static_cast<double>(b.size.height) * b.size.height);
      out.at(u, v) = static_cast<float>(sum / (kFine * kFine) * (1 - b.falloff * r2));
    }
  return out;
}

inline void plantBoard(const std::filesystem::path& file, const DrawnBoard& board) {
  std::filesystem::create_directories(file.parent_path());
  writePng(file, encodeSrgb8(drawBoard(board).view()).view());
}

// a.png ... e.png in `folder`: enough for a lens of 400 px. e.png shows no board.
inline void plantBoards(const std::filesystem::path& folder, DrawnBoard board = {}) {
  const std::array<double, 3> turns[] = {
      {0.35, 0, 0}, {0, 0.4, 0.1}, {-0.35, 0.1, 0}, {0.1, -0.4, -0.1}};
  for (int i = 0; i < 4; ++i) {
    board.turn_rad = turns[i];
    plantBoard(folder / (std::string(1, static_cast<char>('a' + i)) + ".png"), board);
  }
  board.away = 1e4;
  plantBoard(folder / "e.png", board);
}

}  // namespace patina::testing
