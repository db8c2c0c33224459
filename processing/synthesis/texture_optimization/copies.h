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

// The least distance between two places of the result that show the same landmark, over the
// sample's smaller side: of connected patches that show an eighth of it or more, whichever, middle
// from middle. Two that show it at the same place, but for a twelfth of the side, are one copy. 0:
// none is shown twice. Copies on a square grid that show each place of the sample once lie 1 apart.
double landmarksApart(const OptimizedField& field);

}  // namespace patina::texture_optimization
