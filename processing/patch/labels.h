// SPDX-License-Identifier: GPL-3.0-or-later
// Patches of a source that are shown only where a target has them, and only as the same copy: a
// neighbour's would otherwise be shown twice side by side.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"

namespace patina::patch {

struct Labels {
  // What a target texel may show: a label of the source, in a copy of it that begins at x, y of the
  // target, which may lie outside.
  struct Copy {
    std::int32_t label = -1;  // none
    int x = 0, y = 0;
  };

  SizePx source, target;
  bool wraps = false;  // the target goes on at its other side
  int slack = 0;       // texels a copy may begin beside its place, x and y
  std::vector<std::int32_t> of_source =
      {};                            // [h][w] of the patch centred there; -1: shown anywhere
  std::vector<Copy> of_target = {};  // [h][w]; both are empty, or none

  // Of the patch centred at `centre`, at `at` of the target; both y * width + x.
  bool refuse(std::int32_t centre, std::size_t at) const {
    return !of_source.empty() && of_source[static_cast<std::size_t>(centre)] >= 0 &&
           !hasCopy(centre, at);
  }
  bool hasCopy(std::int32_t centre, std::size_t at) const;
};

}  // namespace patina::patch
