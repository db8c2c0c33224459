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

namespace {

// [columns][n] of [n][columns].
std::vector<float> byColumn(std::span<const float> rows, Index n) {
  const Index columns = static_cast<Index>(rows.size()) / n;
  std::vector<float> out(rows.size());
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < columns; ++k) out[k * n + j] = rows[j * columns + k];
  return out;
}

// out [l][count] = a [l][n] times a panel of a block.
void multiply(std::span<const float> a, Index l, Index n, const SampleBlock& block, Index first,
              Index count, float* out, Index out_stride) {
  cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, l, count, n, 1.0f, a.data(), n,
              block.data + first, block.stride, 0.0f, out, out_stride);
}

Index panelsOf(Index count) { return (count + kPanelTexels - 1) / kPanelTexels; }

}  // namespace

std::vector<float> randomColumns(Index n, Index columns) {
  std::vector<float> out(static_cast<std::size_t>(n * columns));
  tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t i) {
    out[i] = static_cast<float>(gaussian(hashSeed(0x736b65746368, i)));
  });
  return out;
}

RangeSketch::RangeSketch(Index n, std::vector<float> omega)
    : n_(n),
      columns_(static_cast<Index>(omega.size()) / n),
      omega_(std::move(omega)),
      omega_by_column_(byColumn(omega_, n)) {}

void RangeSketch::add(const SampleBlock& block) {
  const Index panels = panelsOf(block.count);
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
    multiply(omega_by_column_, columns_, n_, block, first, count, room.range.data(), count);
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n_, columns_, count, 1.0f,
                block.data + first, block.stride, room.range.data(), count, 0.0f,
                room.product.data(), columns_);
    std::vector<double>& sum = sums_[p];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += room.product[i];
  });
}

RangeSketch::Range RangeSketch::range(Index m, std::span<const double> mean,
                                      std::span<const float> weight) const {
  std::vector<double> z = sums_.front(), mean_range(columns_);
  for (std::size_t p = 1; p < sums_.size(); ++p)
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += sums_[p][i];
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k) mean_range[k] += mean[j] * omega_[j * columns_ + k];
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k)
      z[j * columns_ + k] -= static_cast<double>(m) * mean[j] * mean_range[k];
  Range range{{}, ritzValues(z, weight)};
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k) z[j * columns_ + k] *= weight[j];
  const int n = static_cast<int>(n_), l = static_cast<int>(columns_);
  std::vector<double> tau(columns_);
  int failed = LAPACKE_dgeqrf(LAPACK_ROW_MAJOR, n, l, z.data(), l, tau.data());
  if (failed == 0) failed = LAPACKE_dorgqr(LAPACK_ROW_MAJOR, n, l, l, z.data(), l, tau.data());
  PATINA_CHECK(failed == 0);
  range.basis = std::move(z);
  return range;
}

std::vector<double> RangeSketch::ritzValues(const std::vector<double>& z,
                                            std::span<const float> weight) const {
  const std::vector<double> omega(omega_.begin(), omega_.end());
  std::vector<double> whitened = omega, values(columns_), energy(columns_ * columns_),
                      size(columns_ * columns_);
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k)
      whitened[j * columns_ + k] *= weight[j] > 0 ? 1.0 / weight[j] : 0.0;
  const int l = static_cast<int>(columns_);
  cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, l, l, n_, 1.0, omega.data(), l, z.data(), l,
              0.0, energy.data(), l);
  cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, l, n_, 1.0, whitened.data(), l, 0.0,
              size.data(), l);
  if (LAPACKE_dsygvd(LAPACK_ROW_MAJOR, 1, 'N', 'L', l, energy.data(), l, size.data(), l,
                     values.data()) != 0)
    std::fill(values.begin(), values.end(), 0.0);
  return values;
}

void Scores::add(Index first, const SampleBlock& block, Index n, std::span<const float> projection,
                 std::span<const float> offset) {
  const std::vector<float> by_column = byColumn(projection, n);
  tbb::parallel_for(Index{0}, panelsOf(block.count), [&](Index p) {
    const Index at = p * kPanelTexels, count = std::min(kPanelTexels, block.count - at);
    float* out = values_.data() + first + at;
    multiply(by_column, l_, n, block, at, count, out, m_);
    for (Index k = 0; k < l_; ++k)
      for (Index i = 0; i < count; ++i) out[k * m_ + i] -= offset[k];
  });
}

std::vector<double> Scores::gram() const {
  constexpr Index kRows = 4096;
  const Index parts = (m_ + kRows - 1) / kRows;
  std::vector<std::vector<double>> sums(static_cast<std::size_t>(parts));
  tbb::parallel_for(Index{0}, parts, [&](Index part) {
    const Index first = part * kRows, count = std::min(kRows, m_ - first);
    std::vector<double> rows;
    rows.reserve(static_cast<std::size_t>(l_ * count));
    for (Index k = 0; k < l_; ++k)
      rows.insert(rows.end(), values_.begin() + k * m_ + first,
                  values_.begin() + k * m_ + first + count);
    sums[part].resize(static_cast<std::size_t>(l_ * l_));
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasNoTrans, l_, count, 1.0, rows.data(), count, 0.0,
                sums[part].data(), l_);
  });
  std::vector<double> gram(static_cast<std::size_t>(l_ * l_));
  for (const std::vector<double>& sum : sums)
    for (std::size_t i = 0; i < gram.size(); ++i) gram[i] += sum[i];
  return gram;
}

std::vector<float> Scores::rotated(std::span<const float> rotation, Index k) const {
  std::vector<float> out(static_cast<std::size_t>(m_ * k));
  tbb::parallel_for(Index{0}, panelsOf(m_), [&](Index part) {
    const Index first = part * kPanelTexels, count = std::min(kPanelTexels, m_ - first);
    cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, count, k, l_, 1.0f, values_.data() + first,
                m_, rotation.data(), k, 0.0f, out.data() + first * k, k);
  });
  return out;
}

std::vector<float> Scores::byTexel() const {
  std::vector<float> out(values_.size());
  tbb::parallel_for(Index{0}, panelsOf(m_), [&](Index part) {
    const Index end = std::min(m_, (part + 1) * kPanelTexels);
    for (Index i = part * kPanelTexels; i < end; ++i)
      for (Index k = 0; k < l_; ++k) out[i * l_ + k] = values_[k * m_ + i];
  });
  return out;
}

}  // namespace patina::decomposition
