// SPDX-License-Identifier: GPL-3.0-or-later
// The options by which a board is told, for every verb that looks for one.
#pragma once

#include <optional>
#include <string>

#include "calibration/lens/board.h"
#include "capture/app/command_line.h"

namespace patina::app {

struct BoardOptions {
  std::optional<SizePx> chessboard, charuco;  // in corners and in squares
  double square_mm = 0, marker_mm = 0;
};
// `options` lives until the verb has run.
void addBoardOptions(Verb& verb, BoardOptions& options);
// Nothing when no board was told. Without --square a square is `square_mm`; 0: it must be told.
std::optional<calibration::BoardSpec> boardOf(const BoardOptions& options, double square_mm);

double parseMillimetres(const std::string& text);  // "20", "20mm", "2cm"; Failure(kUsage)

}  // namespace patina::app
