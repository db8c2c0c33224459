// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/gram_matrix.h"

#include <cblas.h>
#include <lapacke.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "processing/image/failure.h"

namespace patina::decomposition {

GramMatrix::GramMatrix(Index n)
    : n_(n),
      tile_(std::clamp<Index>((n + 3) / 4, 32, 256)),
      gram_(static_cast<std::size_t>(n * n)),
      panel_(static_cast<std::size_t>(n * kPanelTexels)) {
  const Index tiles = (n_ + tile_ - 1) / tile_;
  for (Index i = 0; i < tiles; ++i)
    for (Index j = 0; j <= i; ++j) tiles_.push_back({i * tile_, j * tile_});
}

void GramMatrix::add(const SampleBlock& block) {
  tbb::enumerable_thread_specific<std::vector<float>> rooms;
  for (Index first = 0; first < block.count; first += kPanelTexels) {
    const Index count = std::min(kPanelTexels, block.count - first);
    tbb::parallel_for(Index{0}, n_, [&](Index j) {
      const FloatRows row = floatRows(block, j, 1, first, count, rooms.local());
      std::copy(row.data, row.data + count, panel_.begin() + j * kPanelTexels);
    });
    tbb::parallel_for(std::size_t{0}, tiles_.size(),
                      [&](std::size_t t) { addTile(tiles_[t], count); });
  }
}

void GramMatrix::addTile(const Origin& at, Index panel_texels) {
  const Index height = std::min(tile_, n_ - at.row), width = std::min(tile_, n_ - at.column);
  const double *rows = panel_.data() + at.row * kPanelTexels,
               *columns = panel_.data() + at.column * kPanelTexels;
  double* out = gram_.data() + at.row * n_ + at.column;
  if (at.row == at.column)
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasNoTrans, height, panel_texels, 1.0, rows,
                kPanelTexels, 1.0, out, n_);
  else
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, height, width, panel_texels, 1.0, rows,
                kPanelTexels, columns, kPanelTexels, 1.0, out, n_);
}

void GramMatrix::centreAndWeigh(Index m, std::span<const double> mean,
                                std::span<const float> weight) {
  tbb::parallel_for(Index{0}, n_, [&](Index i) {
    for (Index j = 0; j <= i; ++j) {
      double& g = gram_[i * n_ + j];
      g = (g - static_cast<double>(m) * mean[i] * mean[j]) * weight[i] * weight[j];
    }
  });
}

double GramMatrix::trace() const {
  double sum = 0;
  for (Index i = 0; i < n_; ++i) sum += gram_[i * n_ + i];
  return sum;
}

GramMatrix::Eigen GramMatrix::eigen() && {
  Eigen eigen{std::move(gram_), std::vector<double>(static_cast<std::size_t>(n_))};
  const int n = static_cast<int>(n_);
  // Row-major lower is column-major upper: nothing is transposed.
  const int failed =
      LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', n, eigen.vectors.data(), n, eigen.values.data());
  PATINA_CHECK(failed == 0);
  std::reverse(eigen.values.begin(), eigen.values.end());  // dsyevd sorts upwards
  for (Index i = 0; i < n_ / 2; ++i)
    std::swap_ranges(eigen.vectors.begin() + i * n_, eigen.vectors.begin() + (i + 1) * n_,
                     eigen.vectors.begin() + (n_ - 1 - i) * n_);
  for (double& v : eigen.values) v = std::max(v, 0.0);
  return eigen;
}

}  // namespace patina::decomposition
