// SPDX-License-Identifier: GPL-3.0-or-later
// The cost of the best cut across one strip of an overlap, by dynamic programming (Efros and
// Freeman 2001, section 2.1): quick, so that many candidates can be told apart by how well they
// would join.
#pragma once

#include "processing/image/image.h"

namespace patina::patch {

// Least sum of `difference` along a path through `strip` that takes one texel of each row and moves
// at most one column from row to row. O(texels of the strip).
double cutAlongRows(ImageView<const double> difference, RectPx strip);
// The same, one texel of each column.
double cutAlongColumns(ImageView<const double> difference, RectPx strip);

}  // namespace patina::patch
