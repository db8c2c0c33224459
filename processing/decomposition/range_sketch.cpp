// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/range_sketch.h"

#include <cblas.h>
#include <lapacke.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::decomposition {

namespace {

constexpr double kRounding = 1e-11;  // of squares, where scores are floats
// Texels that teach how T hangs on Y: at least so many, or that share where there are more.
constexpr Index kTaught = 1 << 16, kTaughtShare = 8;
constexpr Index kGramTexels = 4096;  // at a time

// [columns][n] of [n][columns].
std::vector<float> byColumn(std::span<const float> rows, Index n) {
  const Index columns = static_cast<Index>(rows.size()) / n;
  std::vector<float> out(rows.size());
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < columns; ++k) out[k * n + j] = rows[j * columns + k];
  return out;
}

// out [rows][columns] = a [rows][inner] b [inner][columns].
void multiply(const std::vector<double>& a, const std::vector<double>& b, Index rows, Index columns,
              Index inner, std::vector<double>& out) {
  const int n = static_cast<int>(columns), k = static_cast<int>(inner);
  cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, static_cast<int>(rows), n, k, 1.0,
              a.data(), k, b.data(), n, 0.0, out.data(), n);
}

// Rising; the eigenvectors take the place of the symmetric matrix (its lower triangle), a row each.
std::vector<double> eigenvalues(std::vector<double>& matrix, Index size) {
  std::vector<double> values(static_cast<std::size_t>(size));
  const int n = static_cast<int>(size);
  const int failed = LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', n, matrix.data(), n, values.data());
  PATINA_CHECK(failed == 0);
  return values;
}

Index panelsOf(Index count) { return (count + kPanelTexels - 1) / kPanelTexels; }

// [0, m) in parts of `length`, the last perhaps shorter.
std::vector<Range> rangesOf(Index m, Index length) {
  std::vector<Range> ranges;
  for (Index first = 0; first < m; first += length)
    ranges.push_back({first, std::min(length, m - first)});
  return ranges;
}

// g^+ h [l][l] of two symmetric matrices (their lower triangles).
std::vector<double> solved(std::vector<double> g, const std::vector<double>& h, Index l) {
  const std::vector<double> size = eigenvalues(g, l);  // rows of `g` are eigenvectors, rising
  std::vector<double> turned(g.size()), inverse(g.size()), full(h), out(g.size());
  for (Index k = 0; k < l; ++k)
    if (size[k] > kRounding * size[l - 1])
      for (Index i = 0; i < l; ++i) turned[i * l + k] = g[k * l + i] / size[k];
  multiply(turned, g, l, l, l, inverse);
  for (Index i = 0; i < l; ++i)
    for (Index j = 0; j < i; ++j) full[j * l + i] = full[i * l + j];
  multiply(inverse, full, l, l, l, out);
  return out;
}

}  // namespace

std::vector<float> randomColumns(Index n, Index columns) {
  std::vector<float> out(static_cast<std::size_t>(n * columns));
  tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t i) {
    out[i] = static_cast<float>(gaussian(hashSeed(0x736b65746368, i)));
  });
  return out;
}

RangeSketch::RangeSketch(Index m, Index n, std::vector<float> omega)
    : m_(m),
      n_(n),
      columns_(static_cast<Index>(omega.size()) / n),
      omega_(std::move(omega)),
      scores_(m, columns_) {}

// By chance, so that no pattern of the texture agrees with it.
bool RangeSketch::teaches(Index first) const {
  if (!isSampled()) return true;
  const auto share = static_cast<double>(std::max(kTaught, m_ / kTaughtShare));
  return uniform(hashSeed(0x7465616368, first)) * static_cast<double>(m_) < share;
}
bool RangeSketch::isSampled() const { return m_ > kTaught; }

void RangeSketch::add(Index first, const SampleBlock& block) {
  scores_.add(first, block, n_, omega_);
  const Index panels = panelsOf(block.count);
  while (static_cast<Index>(sums_.size()) < panels)
    sums_.push_back({std::vector<double>(static_cast<std::size_t>(n_ * columns_)),
                     std::vector<double>(static_cast<std::size_t>(n_))});
  std::vector<Index> teachers;
  for (Index p = 0; p < panels; ++p)
    if (teaches(first + p * kPanelTexels)) teachers.push_back(p);
  for (Index p : teachers)
    taught_.push_back(
        {first + p * kPanelTexels, std::min(kPanelTexels, block.count - p * kPanelTexels)});
  const Index step = block.rowsAtOnce(n_);
  struct Room {
    std::vector<float> samples, product;
  };
  tbb::enumerable_thread_specific<Room> rooms([&] {
    return Room{{}, std::vector<float>(static_cast<std::size_t>(step * columns_))};
  });
  const std::vector<float> ones(kPanelTexels, 1.0f);
  tbb::parallel_for(std::size_t{0}, teachers.size(), [&](std::size_t i) {
    const Index p = teachers[i], at = p * kPanelTexels,
                count = std::min(kPanelTexels, block.count - at);
    Room& room = rooms.local();
    std::vector<double>&products = sums_[p].products, &samples = sums_[p].samples;
    for (Index row = 0; row < n_; row += step) {
      const Index rows = std::min(step, n_ - row);
      const FloatRows t = floatRows(block, row, rows, at, count, room.samples);
      cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, rows, columns_, count, 1.0f, t.data,
                  t.stride, scores_.from(first + at), scores_.stride(), 0.0f, room.product.data(),
                  columns_);
      for (Index k = 0; k < rows * columns_; ++k) products[row * columns_ + k] += room.product[k];
      cblas_sgemv(CblasRowMajor, CblasNoTrans, rows, count, 1.0f, t.data, t.stride, ones.data(), 1,
                  0.0f, room.product.data(), 1);
      for (Index j = 0; j < rows; ++j) samples[row + j] += room.product[j];
    }
  });
}

// W (T - 1 mean^t)^t (T - 1 mean^t) Omega over the texels that teach.
std::vector<double> RangeSketch::product(std::span<const double> mean,
                                         std::span<const double> offset,
                                         std::span<const float> weight) const {
  Sums all = sums_.front();
  for (std::size_t p = 1; p < sums_.size(); ++p) {
    for (std::size_t i = 0; i < all.products.size(); ++i) all.products[i] += sums_[p].products[i];
    for (std::size_t j = 0; j < all.samples.size(); ++j) all.samples[j] += sums_[p].samples[j];
  }
  Index count = 0;
  for (const Range& range : taught_) count += range.count;
  std::vector<double>&z = all.products, scores(static_cast<std::size_t>(columns_));
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k) scores[k] += all.samples[j] * omega_[j * columns_ + k];
  for (Index j = 0; j < n_; ++j) {
    const double off = all.samples[j] - static_cast<double>(count) * mean[j];
    for (Index k = 0; k < columns_; ++k) {
      double& v = z[j * columns_ + k];
      v = (v - mean[j] * scores[k] - off * offset[k]) * weight[j];
    }
  }
  return std::move(z);
}

RangeSketch::Factors RangeSketch::factors(std::span<const double> mean,
                                          std::span<const float> weight) {
  const Index l = columns_;
  const auto square = static_cast<std::size_t>(l * l);
  std::vector<double> offset(static_cast<std::size_t>(l));
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < l; ++k) offset[k] += mean[j] * omega_[j * l + k];
  scores_.subtract(offset);
  std::vector<double> gram = scores_.gram(rangesOf(m_, kGramTexels));
  Factors out{{}, {}, std::vector<double>(square), ritzValues(gram, weight)};
  // Y E D^-1/2 is orthonormal where Y^t Y = E D E^t; B = D^-1/2 E^t Z^t is T on it.
  std::vector<double> z = product(mean, offset, weight);
  if (isSampled())  // as if of all
    multiply(std::vector<double>(z), solved(scores_.gram(taught_), gram, l), n_, l, l, z);
  const std::vector<double> size = eigenvalues(gram, l);
  std::vector<double> whiten(square), b(static_cast<std::size_t>(n_ * l)), energy(square);
  for (Index k = 0; k < l; ++k)  // rows of `gram` are eigenvectors, rising
    if (size[k] > kRounding * size[l - 1])
      for (Index i = 0; i < l; ++i) whiten[i * l + k] = gram[k * l + i] / std::sqrt(size[k]);
  multiply(z, whiten, n_, l, l, b);
  cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, static_cast<int>(l), static_cast<int>(n_), 1.0,
              b.data(), static_cast<int>(l), 0.0, energy.data(), static_cast<int>(l));
  const std::vector<double> squares = eigenvalues(energy, l);
  std::vector<double> turn(square), turn_basis(square);
  for (Index k = 0; k < l; ++k) {
    const Index from = l - 1 - k;
    out.squares.push_back(std::max(0.0, squares[from]));
    if (!(out.squares[k] > kRounding * out.squares[0])) continue;
    const double s = std::sqrt(out.squares[k]);
    for (Index i = 0; i < l; ++i) {
      turn[i * l + k] = energy[from * l + i] * s;
      turn_basis[i * l + k] = energy[from * l + i] / s;
    }
  }
  multiply(whiten, turn, l, l, l, out.rotation);
  out.basis.resize(b.size());
  multiply(b, turn_basis, n_, l, l, out.basis);
  return out;
}

std::vector<double> RangeSketch::ritzValues(std::vector<double> gram,
                                            std::span<const float> weight) const {
  std::vector<double> whitened(omega_.begin(), omega_.end()), values(columns_), size(gram.size());
  for (Index j = 0; j < n_; ++j)
    for (Index k = 0; k < columns_; ++k)
      whitened[j * columns_ + k] *= weight[j] > 0 ? 1.0 / weight[j] : 0.0;
  const int l = static_cast<int>(columns_);
  cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, l, static_cast<int>(n_), 1.0, whitened.data(),
              l, 0.0, size.data(), l);
  if (LAPACKE_dsygvd(LAPACK_ROW_MAJOR, 1, 'N', 'L', l, gram.data(), l, size.data(), l,
                     values.data()) != 0)
    std::fill(values.begin(), values.end(), 0.0);
  std::reverse(values.begin(), values.end());
  return values;
}

void Scores::add(Index first, const SampleBlock& block, Index n, std::span<const float> vectors) {
  const std::vector<float> by_column = byColumn(vectors, n);
  const Index step = block.rowsAtOnce(n);
  tbb::enumerable_thread_specific<std::vector<float>> rooms;
  tbb::parallel_for(Index{0}, panelsOf(block.count), [&](Index p) {
    const Index at = p * kPanelTexels, count = std::min(kPanelTexels, block.count - at);
    for (Index row = 0; row < n; row += step) {
      const Index rows = std::min(step, n - row);
      const FloatRows t = floatRows(block, row, rows, at, count, rooms.local());
      cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, l_, count, rows, 1.0f,
                  by_column.data() + row, n, t.data, t.stride, row > 0 ? 1.0f : 0.0f,
                  values_.data() + first + at, m_);
    }
  });
}

void Scores::subtract(std::span<const double> offset) {
  tbb::parallel_for(Index{0}, l_, [&](Index k) {
    const auto shift = static_cast<float>(offset[k]);
    for (Index i = k * m_; i < (k + 1) * m_; ++i) values_[i] -= shift;
  });
}

std::vector<double> Scores::gram(std::span<const Range> of) const {
  std::vector<std::vector<double>> sums(of.size());
  tbb::parallel_for(std::size_t{0}, of.size(), [&](std::size_t part) {
    const auto [first, count] = of[part];
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
