// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/board_options.h"

#include <cmath>

#include "capture/app/context.h"

namespace patina::app {

double parseMillimetres(const std::string& text) {
  double value = 0;
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf%n", &value, &used) == 1 && value > 0 && std::isfinite(value)) {
    const std::string unit = text.substr(static_cast<std::size_t>(used));
    if (unit.empty() || unit == "mm") return value;
    if (unit == "cm") return 10 * value;
    if (unit == "m") return 1000 * value;
  }
  throw AppError(Exit::kUsage, "'" + text + "' is no length: 20mm, 2cm");
}

void addBoardOptions(Verb& verb, BoardOptions& options) {
  verb.option("--board", options.chessboard, parseSize, "9x6",
              "A chessboard, by its inner corners: one less than squares each way")
      .option("--charuco", options.charuco, parseSize, "7x5",
              "A ChArUco board, by its squares; markers of ArUco's 4x4 dictionaries")
      .option("--square", options.square_mm, parseMillimetres, "20mm", "Side of a square")
      .option("--marker", options.marker_mm, parseMillimetres, "15mm",
              "Side of a marker's black (default on a ChArUco board: 3/4 of a square)");
}

std::optional<calibration::BoardSpec> boardOf(const BoardOptions& options, double square_mm) {
  if (!options.chessboard && !options.charuco) return std::nullopt;
  if (options.chessboard && options.charuco)
    throw AppError(Exit::kUsage, "give either --board or --charuco");
  const bool charuco = options.charuco.has_value();
  const SizePx size = charuco ? *options.charuco : *options.chessboard;
  calibration::BoardSpec board;
  board.kind = charuco ? calibration::BoardSpec::kCharuco : calibration::BoardSpec::kChessboard;
  board.columns = size.width;
  board.rows = size.height;
  board.square_mm = options.square_mm > 0 ? options.square_mm : square_mm;
  if (!(board.square_mm > 0))
    throw AppError(Exit::kUsage, "how large are the squares? Give --square, such as 5mm");
  if (charuco) board.marker_mm = options.marker_mm > 0 ? options.marker_mm : board.square_mm * 0.75;
  board.check();
  return board;
}

}  // namespace patina::app
