// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures that tell a whole sequence or run at a glance: contact sheet, keogram, plate of
// textures, chart of the light.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/film.h"
#include "capture/workflow/light_report.h"
#include "capture/workflow/sequence.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct SheetRequest {
  ShowOptions show{};
  int cells = 24;  // at most; spread evenly over the frames, first and last included
  int columns = 0;
  int cell_width_px = 220;
  std::optional<RectPx> region{};  // of the frames; nothing: the whole. WorkflowError(kUsage)
};
Image<std::uint8_t> makeSheet(const Sequence& sequence, const SheetRequest& request,
                              Progress& progress);

struct KeogramRequest {
  ShowOptions show{};
  int column = -1;  // px from the left; -1: the middle
  int width_px = 3;
};
Image<std::uint8_t> makeKeogram(const Sequence& sequence, const KeogramRequest& request,
                                Progress& progress);

struct PlateSubject {
  std::string name, detail;
  Sequence sequence;
};
Image<std::uint8_t> makePlate(const std::vector<PlateSubject>& subjects, int columns, int cell_px,
                              Progress& progress);

Image<std::uint8_t> drawLight(const LightReport& report);

// Indices of `wanted` of `frames` frames, evenly spread, first and last included.
std::vector<std::int64_t> spreadEvenly(std::int64_t frames, std::int64_t wanted);

}  // namespace patina::workflow
