// SPDX-License-Identifier: GPL-3.0-or-later
// Where seams may run: a step is lost among much detail and stands out where all is calm, but a
// minimum cut by differences alone seeks the calm (Kwatra et al. 2003, section 3.1, divide by the
// gradients of both sides). Here an edge costs less by the mean gradient of all blocks that were
// laid over it, whichever of them are shown: so costs of one edge keep to the triangle inequality.
#pragma once

#include <array>
#include <cstddef>

#include "processing/image/image.h"

namespace patina::quilting {

class SeamWeights {
 public:
  // `typical`: the mean gradient of the material. `ragged`: weights of edges in a direction are
  // multiplied by a factor drawn between its exponential and one over that, so that a seam across
  // strokes, which costs the same wherever it runs, does not end them all along one straight line.
  SeamWeights(SizePx canvas, double typical, std::array<double, 2> ragged);

  // A block laid over the edge from (x,y) to the right (direction 0) or down (1) has so much there.
  void add(std::size_t direction, int x, int y, double gradient);

  // How much liveliness counts: weights are its power with this exponent, negative; 0: all are 1.
  // O(canvas), since all weights are reckoned at once; until the next add().
  void setExponent(double exponent);
  double at(std::size_t direction, int x, int y) const;

 private:
  double typical_;
  float exponent_ = 0.5f;
  Image<float> chance_;  // [h][w][2]: the factor drawn; empty: 1
  Image<float> sum_;     // [h][w][2], in typical gradients
  Image<float> count_;
  Image<float> known_;  // weights of all edges; empty: reckoned as they are asked for
};

}  // namespace patina::quilting
