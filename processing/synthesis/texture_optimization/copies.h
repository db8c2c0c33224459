// SPDX-License-Identifier: GPL-3.0-or-later
// How far apart a result shows the same place of the sample: what gives copying away is a landmark
// that is seen twice at a glance.
#pragma once

#include "processing/synthesis/texture_optimization/optimize.h"

namespace patina::texture_optimization {

// Of the sample's cells (a sixteenth of its smaller side) the least distance between two separate
// copied regions that show three quarters of the cell or more, over that side. A copied region is
// connected and shows the sample without a break.
struct CopiesApart {
  double shown_again = 0;                       // share of the cells that are shown twice or more
  double least = 0, twentieth = 0, median = 0;  // of those; twentieth: a twentieth are nearer.
                                                // 0: nothing is shown twice
};
CopiesApart copiesApart(const OptimizedField& field);

}  // namespace patina::texture_optimization
