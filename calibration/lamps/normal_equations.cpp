// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/normal_equations.h"

#include <Eigen/Cholesky>

namespace patina::calibration {
namespace {

Eigen::Map<const Eigen::MatrixXd> mapped(const std::vector<double>& matrix, int unknowns) {
  return {matrix.data(), unknowns, unknowns};
}

std::vector<double> plain(const Eigen::MatrixXd& values) {
  return {values.data(), values.data() + values.size()};
}

}  // namespace

void NormalEquations::add(std::span<const double> row, double value, double weight) {
  for (int i = 0; i < unknowns_; ++i) {
    const double scaled = weight * row[i];
    right_[i] += scaled * value;
    for (int j = 0; j < unknowns_; ++j) matrix_[index(i, j)] += scaled * row[j];
  }
}

std::vector<double> NormalEquations::solved() const {
  const Eigen::Map<const Eigen::VectorXd> right(right_.data(), unknowns_);
  return plain(mapped(matrix_, unknowns_).ldlt().solve(right));
}

std::vector<double> NormalEquations::covariance() const {
  return plain(
      mapped(matrix_, unknowns_).ldlt().solve(Eigen::MatrixXd::Identity(unknowns_, unknowns_)));
}

}  // namespace patina::calibration
