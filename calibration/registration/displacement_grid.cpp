// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/displacement_grid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr double kBending = 100;      // 1/px^2: a tenth of a pixel of bending is nothing odd
constexpr double kHeld = 1e-3;        // 1/px^2: where nothing is said a point stays
constexpr double kLeastShared = 0.1;  // less is not told from noise in a cell
constexpr int kSteps = 200;
constexpr double kDone = 1e-12;  // of the squared right side

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// C H^-1, by generalised eigenvectors, C v = share H v, each share held to what can be.
Eigen::Matrix2d sharedOf(const PixelSays& sum) {
  const double least = 1e-9 * (sum.xx + sum.yy);
  const Eigen::Matrix2d h{{sum.xx + least, sum.xy}, {sum.xy, sum.yy + least}},
      c{{sum.shared_xx, sum.shared_xy}, {sum.shared_xy, sum.shared_yy}};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> both(c, h);
  const Eigen::Vector2d shares = both.eigenvalues().cwiseMax(kLeastShared).cwiseMin(1.0);
  return h * both.eigenvectors() * shares.asDiagonal() * both.eigenvectors().transpose();
}

}  // namespace

DisplacementGrid::DisplacementGrid(SizePx points, int spacing_px)
    : points_(points),
      spacing_px_(spacing_px),
      cells_(static_cast<std::size_t>(points.width - 1) * (points.height - 1)) {}

std::array<std::size_t, 8> DisplacementGrid::unknownsOf(int i, int j) const {
  std::array<std::size_t, 8> out{};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const std::size_t point = (static_cast<std::size_t>(j) + corner / 2) * points_.width +
                              static_cast<std::size_t>(i) + corner % 2;
    out[2 * corner] = 2 * point, out[2 * corner + 1] = 2 * point + 1;
  }
  return out;
}

void DisplacementGrid::addPixel(const PixelSays& says, double fx, double fy, Cell& cell) {
  const double shares[] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  for (std::size_t p = 0; p < 4; ++p) {
    cell.r[2 * p] += shares[p] * says.x, cell.r[2 * p + 1] += shares[p] * says.y;
    for (std::size_t q = 0; q < 4; ++q) {
      const double both = shares[p] * shares[q];
      cell.h[16 * p + 2 * q] += both * says.xx, cell.h[16 * p + 2 * q + 1] += both * says.xy;
      cell.h[16 * p + 8 + 2 * q] += both * says.xy;
      cell.h[16 * p + 8 + 2 * q + 1] += both * says.yy;
    }
  }
  cell.sum.xx += says.xx, cell.sum.xy += says.xy, cell.sum.yy += says.yy;
  cell.sum.shared_xx += says.shared_xx, cell.sum.shared_xy += says.shared_xy;
  cell.sum.shared_yy += says.shared_yy;
}

void DisplacementGrid::weigh(Cell& cell) {
  const Eigen::Matrix2d share = sharedOf(cell.sum);
  for (std::size_t p = 0; p < 4; ++p) {
    Eigen::Map<Eigen::Vector2d> r(&cell.r[2 * p]);
    r = (share * r).eval();
    for (std::size_t q = 0; q < 4; ++q) {
      double* h = &cell.h[16 * p + 2 * q];
      const Eigen::Matrix2d kept =
          share * Eigen::Matrix2d{{h[0], h[1]}, {h[8], h[9]}} * share.transpose();
      h[0] = kept(0, 0), h[1] = kept(0, 1), h[8] = kept(1, 0), h[9] = kept(1, 1);
    }
  }
}

void DisplacementGrid::add(SizePx picture, const std::function<PixelSays(int x, int y)>& says) {
  const int columns = points_.width - 1, rows = points_.height - 1;
  const auto begin = [&](int cell) { return std::max(1, cell * spacing_px_); };
  const auto end = [&](int cell, int cells, int side) {  // the last takes what is left
    return cell + 1 == cells ? side - 1 : std::min(side - 1, (cell + 1) * spacing_px_);
  };
  forEachRow(rows, std::int64_t{1} << 16, [&](int j) {
    for (int i = 0; i < columns; ++i) {
      Cell cell;
      for (int y = begin(j); y < end(j, rows, picture.height); ++y)
        for (int x = begin(i); x < end(i, columns, picture.width); ++x) {
          const PixelSays s = says(x, y);
          if (s.xx + s.yy <= 0) continue;
          addPixel(s, std::min(static_cast<double>(x) / spacing_px_ - i, 1.0),
                   std::min(static_cast<double>(y) / spacing_px_ - j, 1.0), cell);
        }
      if (cell.sum.xx + cell.sum.yy <= 0) continue;
      weigh(cell);
      Cell& said = cells_[static_cast<std::size_t>(j) * columns + i];
      for (std::size_t k = 0; k < cell.h.size(); ++k) said.h[k] += cell.h[k];
      for (std::size_t k = 0; k < cell.r.size(); ++k) said.r[k] += cell.r[k];
    }
  });
}

// Along both axes and, twice, across them: the bending of a thin plate.
void DisplacementGrid::addBending(const std::vector<double>& d, std::vector<double>& out) const {
  const int columns = points_.width, rows = points_.height;
  const auto add = [&](int first, std::array<int, 4> steps, std::array<double, 4> shares,
                       double weight) {
    for (int c = 0; c < 2; ++c) {
      const auto unknown = [&](std::size_t k) {
        return 2 * static_cast<std::size_t>(first + steps[k]) + static_cast<std::size_t>(c);
      };
      double bent = 0;
      for (std::size_t k = 0; k < 4; ++k) bent += shares[k] * d[unknown(k)];
      for (std::size_t k = 0; k < 4; ++k) out[unknown(k)] += weight * shares[k] * bent;
    }
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int at = j * columns + i;
      if (i + 2 < columns) add(at, {0, 1, 2, 0}, {1, -2, 1, 0}, kBending);
      if (j + 2 < rows) add(at, {0, columns, 2 * columns, 0}, {1, -2, 1, 0}, kBending);
      if (i + 1 < columns && j + 1 < rows)
        add(at, {0, 1, columns, columns + 1}, {1, -1, -1, 1}, 2 * kBending);
    }
}

std::vector<double> DisplacementGrid::times(const std::vector<double>& d) const {
  std::vector<double> out(d.size());
  for (std::size_t k = 0; k < d.size(); ++k) out[k] = kHeld * d[k];
  const int columns = points_.width - 1;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const auto at = unknownsOf(static_cast<int>(k) % columns, static_cast<int>(k) / columns);
    for (std::size_t p = 0; p < 8; ++p)
      for (std::size_t q = 0; q < 8; ++q) out[at[p]] += cells_[k].h[8 * p + q] * d[at[q]];
  }
  addBending(d, out);
  return out;
}

void DisplacementGrid::solve(const Image<float>& start, Image<float>& field) const {
  const std::size_t n = field.texels().size();
  std::vector<double> moved(n), bent(n), left(n), inverse(n, kHeld + kBending), step(n), way(n);
  for (std::size_t k = 0; k < n; ++k) moved[k] = field.texels()[k] - start.texels()[k];
  addBending(moved, bent);
  for (std::size_t k = 0; k < n; ++k) left[k] = -bent[k];
  const int columns = points_.width - 1;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const auto at = unknownsOf(static_cast<int>(k) % columns, static_cast<int>(k) / columns);
    for (std::size_t p = 0; p < 8; ++p)
      left[at[p]] += cells_[k].r[p], inverse[at[p]] += cells_[k].h[9 * p];
  }
  for (double& value : inverse) value = 1 / value;  // of the diagonal, near enough
  const auto scaled = [&] {
    std::vector<double> out(n);
    for (std::size_t k = 0; k < n; ++k) out[k] = inverse[k] * left[k];
    return out;
  };
  way = scaled();
  double size = dot(left, way);
  const double done = kDone * size;
  for (int k = 0; k < kSteps && size > done; ++k) {
    const std::vector<double> forward = times(way);
    const double length = size / dot(way, forward);
    for (std::size_t i = 0; i < n; ++i) step[i] += length * way[i], left[i] -= length * forward[i];
    const std::vector<double> next = scaled();
    const double now = dot(left, next);
    for (std::size_t i = 0; i < n; ++i) way[i] = next[i] + now / size * way[i];
    size = now;
  }
  for (std::size_t k = 0; k < n; ++k) field.texels()[k] += static_cast<float>(step[k]);
}

}  // namespace patina::calibration
