// SPDX-License-Identifier: GPL-3.0-or-later
// G = T^t T, summed block by block in double. Inside this room only.
#pragma once

#include <span>
#include <vector>

#include "processing/decomposition/sample_block.h"

namespace patina::decomposition {

// The lower triangle of G is cut into square tiles; a tile is summed by one task over the panels in
// order, so that no sum depends on the number of threads.
class GramMatrix {
 public:
  explicit GramMatrix(Index n);
  void add(const SampleBlock& block);
  // To that of (T - 1 mean^t) W, W diagonal; T of m texels.
  void centreAndWeigh(Index m, std::span<const double> mean, std::span<const float> weight);
  double trace() const;

  struct Eigen {
    std::vector<double> vectors;  // [n][n], a row each, by falling eigenvalue
    std::vector<double> values;   // [n], falling, none below 0
  };
  Eigen eigen() &&;  // LAPACK dsyevd

 private:
  struct Origin {
    Index row, column;
  };
  void addTile(const Origin& at, Index panel_texels);

  Index n_, tile_;
  std::vector<double> gram_, panel_;
  std::vector<Origin> tiles_;
};

}  // namespace patina::decomposition
