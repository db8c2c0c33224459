// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/temporal_svd.h"

#include <cblas.h>
#include <lapacke.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "processing/image/failure.h"

namespace patina::decomposition {
namespace {

constexpr std::int64_t kBlockFloats = 16 << 20;  // 64 MiB of rows at a time
constexpr std::int64_t kPanelRows = 1024;        // widened to double at a time
constexpr std::int64_t kScoreRows = 256;         // rows of a task in the second pass

using Index = std::int64_t;

template <class Body>
void forEach(Index count, const Body& body) {
  tbb::parallel_for(
      tbb::blocked_range<Index>(0, count, 1),
      [&](const tbb::blocked_range<Index>& r) {
        for (Index i = r.begin(); i < r.end(); ++i) body(i);
      },
      tbb::simple_partitioner());
}

// G = T^t T and the column sums. The lower triangle of G is cut into square tiles; a tile is summed
// by one task over the panels in order, so that no sum depends on the number of threads.
class GramMatrix {
 public:
  explicit GramMatrix(Index n)
      : n_(n),
        tile_(std::clamp<Index>((n + 3) / 4, 32, 256)),
        gram_(static_cast<std::size_t>(n * n)),
        sums_(static_cast<std::size_t>(n)) {
    const Index tiles = (n_ + tile_ - 1) / tile_;
    for (Index i = 0; i < tiles; ++i)
      for (Index j = 0; j <= i; ++j) tile_origins_.push_back({i * tile_, j * tile_});
  }

  void add(std::span<const float> rows) {
    const Index count = static_cast<Index>(rows.size()) / n_;
    for (Index first = 0; first < count; first += kPanelRows) {
      const Index panel_rows = std::min(kPanelRows, count - first);
      widen(rows.data() + first * n_, panel_rows);
      forEach(static_cast<Index>(tile_origins_.size()),
              [&](Index t) { addTile(tile_origins_[t].row, tile_origins_[t].column, panel_rows); });
    }
  }

  // G - m * mean mean^t: the Gram matrix of the centred rows.
  void centre(Index m) {
    forEach(n_, [&](Index i) {
      for (Index j = 0; j <= i; ++j)
        gram_[i * n_ + j] -= sums_[i] * sums_[j] / static_cast<double>(m);
    });
  }

  double trace() const {
    double sum = 0;
    for (Index i = 0; i < n_; ++i) sum += gram_[i * n_ + i];
    return sum;
  }
  const std::vector<double>& columnSums() const { return sums_; }
  std::vector<double>& lowerTriangle() { return gram_; }

 private:
  struct Origin {
    Index row, column;
  };

  void widen(const float* rows, Index count) {
    panel_.resize(static_cast<std::size_t>(kPanelRows * n_));
    forEach((count + 63) / 64, [&](Index part) {
      const Index first = part * 64 * n_, last = std::min(count, (part + 1) * 64) * n_;
      std::copy(rows + first, rows + last, panel_.begin() + first);
    });
  }

  void addTile(Index row, Index column, Index panel_rows) {
    const Index height = std::min(tile_, n_ - row), width = std::min(tile_, n_ - column);
    const double* panel = panel_.data();
    double* out = gram_.data() + row * n_ + column;
    if (row != column) {
      cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, height, width, panel_rows, 1.0,
                  panel + row, n_, panel + column, n_, 1.0, out, n_);
      return;
    }
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, height, panel_rows, 1.0, panel + row, n_,
                1.0, out, n_);
    for (Index i = 0; i < panel_rows; ++i)
      for (Index j = row; j < row + height; ++j) sums_[j] += panel[i * n_ + j];
  }

  Index n_, tile_;
  std::vector<double> gram_, sums_, panel_;
  std::vector<Origin> tile_origins_;
};

void readBlocks(Index m, Index n, const RowSource& rows, Index block_rows, Progress& progress,
                const std::function<void(Index first, std::span<const float>)>& use) {
  const Index count = std::max<Index>(1, std::min(block_rows, kBlockFloats / n));
  std::vector<float> block(static_cast<std::size_t>(std::min(count, m) * n));
  for (Index first = 0; first < m; first += count) {
    const Index here = std::min(count, m - first);
    const std::span<float> part(block.data(), static_cast<std::size_t>(here * n));
    rows(first, here, part);
    use(first, part);
    progress.step(here);
  }
}

int chooseRank(std::span<const double> energies, double total, const SvdOptions& options) {
  if (!(options.rank_error > 0)) return options.rank;
  double left = total;
  for (int k = 1; k <= options.rank; ++k) {
    left -= energies[k - 1];
    if (left < options.rank_error * options.rank_error * total) return k;
  }
  return options.rank;
}

// The last `rank` eigenvectors (dsyevd sorts upwards), each a row of `vectors`, with a sign that
// does not hang on the LAPACK at hand.
std::vector<float> basisFrom(const std::vector<double>& vectors, Index n, int rank) {
  std::vector<float> basis(static_cast<std::size_t>(n * rank));
  for (int k = 0; k < rank; ++k) {
    const double* v = vectors.data() + (n - 1 - k) * n;
    const double largest =
        *std::max_element(v, v + n, [](double a, double b) { return std::abs(a) < std::abs(b); });
    const double sign = largest < 0 ? -1 : 1;
    for (Index i = 0; i < n; ++i) basis[i * rank + k] = static_cast<float>(sign * v[i]);
  }
  return basis;
}

void project(std::span<const float> rows, Index n, const TemporalSvd& svd, float* scores) {
  const Index count = static_cast<Index>(rows.size()) / n, rank = svd.rank;
  std::vector<float> offset(static_cast<std::size_t>(rank));  // mean * V
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < rank; ++k) offset[k] += svd.mean[i] * svd.basis[i * rank + k];
  forEach((count + kScoreRows - 1) / kScoreRows, [&](Index part) {
    const Index first = part * kScoreRows, here = std::min(kScoreRows, count - first);
    float* out = scores + first * rank;
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, here, rank, n, 1.0f,
                rows.data() + first * n, n, svd.basis.data(), rank, 0.0f, out, rank);
    for (Index i = 0; i < here; ++i)
      for (Index k = 0; k < rank; ++k) out[i * rank + k] -= offset[k];
  });
}

}  // namespace

void SvdOptions::check(std::int64_t m, std::int64_t n) const {
  const auto refuse = [](const std::string& what) {
    throw ProcessingError(Exit::kUsage, "singular value decomposition: " + what);
  };
  if (m < 1 || n < 1 || n > 20000)
    refuse("matrix is " + std::to_string(m) + " x " + std::to_string(n) +
           "; allowed: at least 1 row, 1 to 20000 columns");
  if (rank < 1 || rank > std::min(m, n))
    refuse("rank is " + std::to_string(rank) + "; allowed: 1 to " + std::to_string(std::min(m, n)));
  if (!(rank_error >= 0 && rank_error < 1))
    refuse("rank_error is " + std::to_string(rank_error) + "; allowed: 0 to below 1");
  if (block_rows < 1)
    refuse("block_rows is " + std::to_string(block_rows) + "; allowed: at least 1");
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const RowSource& rows,
                        const SvdOptions& options, Progress& progress) {
  options.check(m, n);
  // One thread inside BLAS, many around it: otherwise sums are cut by the number of threads.
  openblas_set_num_threads(1);

  GramMatrix gram(n);
  progress.begin("correlation of frames", m);
  readBlocks(m, n, rows, options.block_rows, progress,
             [&](Index, std::span<const float> block) { gram.add(block); });

  TemporalSvd svd;
  svd.mean.resize(static_cast<std::size_t>(n));
  if (options.centre) {
    gram.centre(m);
    for (Index i = 0; i < n; ++i) svd.mean[i] = static_cast<float>(gram.columnSums()[i] / m);
  }
  const double total = gram.trace();
  if (!std::isfinite(total))
    throw ProcessingError(Exit::kBadData,
                          "singular value decomposition: the input holds NaN or infinity");

  std::vector<double>& vectors = gram.lowerTriangle();
  std::vector<double> energies(static_cast<std::size_t>(n));
  // Row-major lower is column-major upper: nothing is transposed.
  const int failed = LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', static_cast<int>(n), vectors.data(),
                                    static_cast<int>(n), energies.data());
  PATINA_CHECK(failed == 0);
  std::reverse(energies.begin(), energies.end());
  for (double& e : energies) e = std::max(e, 0.0);

  svd.rank = chooseRank(energies, total, options);
  for (double e : energies) svd.singular_values.push_back(std::sqrt(e));
  double left = 0;
  for (Index i = svd.rank; i < n; ++i) left += energies[i];
  svd.relative_error = total > 0 ? std::sqrt(left / total) : 0;
  svd.basis = basisFrom(vectors, n, svd.rank);
  svd.scores.resize(static_cast<std::size_t>(m * svd.rank));

  progress.begin("time-varying coefficients", m);
  readBlocks(m, n, rows, options.block_rows, progress,
             [&](Index first, std::span<const float> block) {
               project(block, n, svd, svd.scores.data() + first * svd.rank);
             });
  return svd;
}

}  // namespace patina::decomposition
