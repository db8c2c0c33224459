// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room: least squares by their normal equations, so that one file alone pays for Eigen.
#pragma once

#include <span>
#include <vector>

namespace patina::calibration {

// sum w a a^T and sum w a b over rows a.x = b, for few unknowns.
class NormalEquations {
 public:
  explicit NormalEquations(int unknowns)
      : unknowns_(unknowns),
        matrix_(static_cast<std::size_t>(unknowns) * unknowns),
        right_(static_cast<std::size_t>(unknowns)) {}

  void add(std::span<const double> row, double value, double weight = 1);
  // Adds to the diagonal: Marquardt's damping, or a weak wish for 0.
  void damp(int unknown, double by) { matrix_[index(unknown, unknown)] += by; }
  double diagonal(int unknown) const { return matrix_[index(unknown, unknown)]; }

  std::vector<double> solved() const;      // by LDL^T, pivoted
  std::vector<double> covariance() const;  // the matrix's inverse, row by row

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * unknowns_ + column;
  }
  int unknowns_;
  std::vector<double> matrix_, right_;
};

}  // namespace patina::calibration
