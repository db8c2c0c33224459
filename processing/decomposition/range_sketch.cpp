// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/range_sketch.h"

#include <cblas.h>
#include <lapacke.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::decomposition {

RangeSketch::RangeSketch(Index n, Index columns)
    : n_(n), columns_(columns), omega_(static_cast<std::size_t>(n * columns)) {
  tbb::parallel_for(std::size_t{0}, omega_.size(), [&](std::size_t i) {
    omega_[i] = static_cast<float>(gaussian(hashSeed(0x736b65746368, i)));
  });
}

void RangeSketch::add(const SampleBlock& block) {
  const Index panels = (block.count + kPanelTexels - 1) / kPanelTexels;
  while (static_cast<Index>(sums_.size()) < panels)
    sums_.emplace_back(static_cast<std::size_t>(n_ * columns_));
  struct Room {
    std::vector<float> range, product;
  };
  tbb::enumerable_thread_specific<Room> rooms([&] {
    return Room{std::vector<float>(kPanelTexels * columns_), std::vector<float>(n_ * columns_)};
  });
  tbb::parallel_for(Index{0}, panels, [&](Index p) {
    const Index first = p * kPanelTexels, count = std::min(kPanelTexels, block.count - first);
    Room& room = rooms.local();
    cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, count, columns_, n_, 1.0f,
                block.data + first, block.stride, omega_.data(), columns_, 0.0f, room.range.data(),
                columns_);
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n_, columns_, count, 1.0f,
                block.data + first, block.stride, room.range.data(), columns_, 0.0f,
                room.product.data(), columns_);
    std::vector<double>& sum = sums_[p];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += room.product[i];
  });
}

std::vector<double> RangeSketch::basis(Index m, std::span<const double> mean,
                                       std::span<const float> weight) const {
  std::vector<double> z = sums_.front(), mean_range(columns_);
  for (std::size_t p = 1; p < sums_.size(); ++p)
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += sums_[p][i];
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k) mean_range[k] += mean[j] * omega_[j * columns_ + k];
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k) {
      double& v = z[j * columns_ + k];
      v = (v - static_cast<double>(m) * mean[j] * mean_range[k]) * weight[j];
    }
  const int n = static_cast<int>(n_), l = static_cast<int>(columns_);
  std::vector<double> tau(columns_);
  int failed = LAPACKE_dgeqrf(LAPACK_ROW_MAJOR, n, l, z.data(), l, tau.data());
  if (failed == 0) failed = LAPACKE_dorgqr(LAPACK_ROW_MAJOR, n, l, l, z.data(), l, tau.data());
  PATINA_CHECK(failed == 0);
  return z;
}

void Scores::add(Index first, const SampleBlock& block, Index n, std::span<const float> projection,
                 std::span<const float> offset) {
  const Index panels = (block.count + kPanelTexels - 1) / kPanelTexels;
  tbb::parallel_for(Index{0}, panels, [&](Index p) {
    const Index at = p * kPanelTexels, count = std::min(kPanelTexels, block.count - at);
    float* out = values_.data() + (first + at) * l_;
    cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, count, l_, n, 1.0f, block.data + at,
                block.stride, projection.data(), l_, 0.0f, out, l_);
    for (Index i = 0; i < count; ++i)
      for (Index k = 0; k < l_; ++k) out[i * l_ + k] -= offset[k];
  });
}

std::vector<double> Scores::gram() const {
  constexpr Index kRows = 4096;
  const Index m = static_cast<Index>(values_.size()) / l_, parts = (m + kRows - 1) / kRows;
  std::vector<std::vector<double>> sums(static_cast<std::size_t>(parts));
  tbb::parallel_for(Index{0}, parts, [&](Index part) {
    const Index first = part * kRows, count = std::min(kRows, m - first);
    const std::vector<double> rows(values_.begin() + first * l_,
                                   values_.begin() + (first + count) * l_);
    sums[part].resize(static_cast<std::size_t>(l_ * l_));
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, l_, count, 1.0, rows.data(), l_, 0.0,
                sums[part].data(), l_);
  });
  std::vector<double> gram(static_cast<std::size_t>(l_ * l_));
  for (const std::vector<double>& sum : sums)
    for (std::size_t i = 0; i < gram.size(); ++i) gram[i] += sum[i];
  return gram;
}

std::vector<float> Scores::rotated(std::span<const float> rotation, Index k) && {
  const Index m = static_cast<Index>(values_.size()) / l_,
              parts = (m + kPanelTexels - 1) / kPanelTexels;
  std::vector<float> out(static_cast<std::size_t>(m * k));
  tbb::parallel_for(Index{0}, parts, [&](Index part) {
    const Index first = part * kPanelTexels, count = std::min(kPanelTexels, m - first);
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, count, k, l_, 1.0f,
                values_.data() + first * l_, l_, rotation.data(), k, 0.0f, out.data() + first * k,
                k);
  });
  values_.clear();
  return out;
}

}  // namespace patina::decomposition
