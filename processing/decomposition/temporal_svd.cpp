// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/temporal_svd.h"

#include <cblas.h>
#include <lapacke.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "processing/decomposition/gram_matrix.h"
#include "processing/decomposition/range_sketch.h"
#include "processing/image/failure.h"

namespace patina::decomposition {
namespace {

constexpr Index kBlockFloats = 16 << 20;  // 64 MiB of samples at a time
constexpr Index kOversampling = 16;       // columns beyond the rank, so that its last is found well
constexpr Index kColumnUnit = 8;          // what BLAS multiplies at once
constexpr Index kUnlearned = 4;           // columns that stay random, in case a start misleads
constexpr int kLearning = 3;              // iterations on the first block
constexpr int kRounds = 4;                // at most, of two passes
constexpr double kCertain = 1e-4;         // error of singular values, of the first
constexpr Index kGramColumns = 4;         // times as many as are sought: the exact way costs less

// Calls use(first, block) over all texels, once a pass.
using UseBlock = std::function<void(Index first, const SampleBlock&)>;
using Pass = std::function<void(const UseBlock& use)>;

// Sum and sum of squares of every column.
class Moments {
 public:
  explicit Moments(Index n) : sum_(n), squares_(n) {}
  void add(const SampleBlock& block) {
    tbb::parallel_for(std::size_t{0}, sum_.size(), [&](std::size_t j) {
      const float* row = block.data + static_cast<Index>(j) * block.stride;
      for (Index first = 0; first < block.count; first += kRun)
        addRun(row + first, std::min(kRun, block.count - first), sum_[j], squares_[j]);
    });
  }
  std::vector<double> mean(Index m) const {
    std::vector<double> mean;
    for (double s : sum_) mean.push_back(s / static_cast<double>(m));
    return mean;
  }
  std::vector<double> variance(Index m) const {
    std::vector<double> variance;
    for (std::size_t j = 0; j < sum_.size(); ++j) {
      const double mean = sum_[j] / static_cast<double>(m);
      variance.push_back(std::max(0.0, squares_[j] / static_cast<double>(m) - mean * mean));
    }
    return variance;
  }
  bool isFinite() const {
    return std::all_of(squares_.begin(), squares_.end(), [](double s) { return std::isfinite(s); });
  }
  // Of (T - 1 offset^t) W.
  double energy(Index m, std::span<const double> offset, std::span<const float> weight) const {
    double energy = 0;
    for (std::size_t j = 0; j < sum_.size(); ++j) {
      const double about =
          squares_[j] - 2 * offset[j] * sum_[j] + static_cast<double>(m) * offset[j] * offset[j];
      energy += std::max(0.0, about) * weight[j] * weight[j];
    }
    return energy;
  }

 private:
  static constexpr Index kRun = 512;  // in float
  static void addRun(const float* v, Index count, double& sum, double& squares) {
    constexpr Index kLanes = 8;
    float s[kLanes] = {}, q[kLanes] = {};
    Index i = 0;
    for (; i + kLanes <= count; i += kLanes)
      for (Index lane = 0; lane < kLanes; ++lane) {
        s[lane] += v[i + lane];
        q[lane] += v[i + lane] * v[i + lane];
      }
    for (; i < count; ++i) {
      s[0] += v[i];
      q[0] += v[i] * v[i];
    }
    for (Index lane = 0; lane < kLanes; ++lane) {
      sum += s[lane];
      squares += q[lane];
    }
  }
  std::vector<double> sum_, squares_;
};

// One decomposition: two passes, and what is between and after them. Where the second shows that
// the range was not found well enough, both again from what was found.
class Decomposition {
 public:
  Decomposition(Index m, Index n, const SvdOptions& options)
      : m_(m), n_(n), options_(options), moments_(n), offset_(n) {
    const Index wanted = options.rank + kOversampling;
    columns_ = std::min(n, (wanted + kColumnUnit - 1) / kColumnUnit * kColumnUnit);
    if (n <= kGramColumns * columns_) gram_.emplace(n);
  }

  TemporalSvd run(const Pass& first, const Pass& second) {
    first([&](Index at, const SampleBlock& block) {
      moments_.add(block);
      if (gram_) {
        gram_->add(block);
        return;
      }
      if (at == 0) sketch_.emplace(n_, learned(block));
      sketch_->add(block);
    });
    if (!moments_.isFinite())
      throw ProcessingError(Exit::kBadData,
                            "singular value decomposition: the input holds NaN or infinity");
    const std::vector<double> mean = moments_.mean(m_);
    if (options_.centre) offset_ = mean;
    svd_.mean.assign(offset_.begin(), offset_.end());
    svd_.weight = weightOf(moments_, m_);
    if (gram_)
      byGram(second);
    else
      bySketch(first, second);
    return std::move(svd_);
  }

 private:
  std::vector<float> weightOf(const Moments& moments, Index m) const {
    return options_.weigh ? options_.weigh(moments.mean(m), moments.variance(m))
                          : std::vector<float>(static_cast<std::size_t>(n_), 1.0f);
  }

  // Where subspace iteration starts: the leading directions of the first block, nearly, which are
  // much of the way to those of all; and some columns of chance, in case that block is unlike.
  std::vector<float> learned(const SampleBlock& block) const {
    std::vector<float> omega = randomColumns(n_, columns_);
    const std::vector<float> random = omega;
    Moments moments(n_);
    moments.add(block);
    if (!moments.isFinite()) return omega;  // all will be refused
    const std::vector<double> mean =
        options_.centre ? moments.mean(block.count) : std::vector<double>(n_);
    const std::vector<float> weight = weightOf(moments, block.count);
    for (int i = 0; i < kLearning; ++i) {
      RangeSketch sketch(n_, std::move(omega));
      sketch.add(block);
      omega = unweighed(sketch.range(block.count, mean, weight).basis, weight);
    }
    const float size = 1 / std::sqrt(static_cast<float>(n_));
    for (Index j = 0; j < n_; ++j)
      for (Index k = columns_ - kUnlearned; k < columns_; ++k)
        omega[j * columns_ + k] = weight[j] * size * random[j * columns_ + k];
    return omega;
  }

  // What T multiplies in place of T W.
  std::vector<float> unweighed(const std::vector<double>& basis,
                               std::span<const float> weight) const {
    std::vector<float> omega(basis.size());
    for (Index j = 0; j < n_; ++j)
      for (Index k = 0; k < columns_; ++k)
        omega[j * columns_ + k] = static_cast<float>(weight[j] * basis[j * columns_ + k]);
    return omega;
  }

  void byGram(const Pass& second) {
    gram_->centreAndWeigh(m_, offset_, svd_.weight);
    const double total = gram_->trace();
    const GramMatrix::Eigen eigen = std::move(*gram_).eigen();
    gram_.reset();
    choose(eigen.values, total);
    std::vector<double> basis(static_cast<std::size_t>(n_ * svd_.rank));
    for (Index j = 0; j < n_; ++j)
      for (Index k = 0; k < svd_.rank; ++k) basis[j * svd_.rank + k] = eigen.vectors[k * n_ + j];
    setBasis(basis);
    svd_.scores =
        scoresOn(std::vector<double>(svd_.basis.begin(), svd_.basis.end()), second).byTexel();
  }

  // Rayleigh and Ritz: the best that the sketched range offers.
  void bySketch(const Pass& first, const Pass& second) {
    for (int round = 1;; ++round) {
      const RangeSketch::Range range = sketch_->range(m_, offset_, svd_.weight);
      sketch_.reset();
      const Scores scores = scoresOn(range.basis, second);
      std::vector<double> vectors = scores.gram(), values(static_cast<std::size_t>(columns_));
      const int l = static_cast<int>(columns_);
      const int failed =
          LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', l, vectors.data(), l, values.data());
      PATINA_CHECK(failed == 0);
      if (round == kRounds || errorOf(values, range.squared_singular_values) <= kCertain)
        return settle(range.basis, scores, vectors, values);
      sketch_.emplace(n_, unweighed(range.basis, svd_.weight));
      first([&](Index, const SampleBlock& block) { sketch_->add(block); });
    }
  }

  // How far the singular values up to the rank may be off, of the first. A multiplication by T^t T
  // leaves of their squares' errors a share below (s_l / s_k)^4, and takes what `now` has above
  // `before`; the square root of that share is reckoned with, since not all columns have converged.
  double errorOf(const std::vector<double>& now, const std::vector<double>& before) const {
    const double first = std::sqrt(std::max(0.0, now.back())), last = std::max(0.0, now.front());
    if (!(first > 0)) return 0;
    double error = 0;
    for (Index k = columns_ - options_.rank; k < columns_; ++k) {
      if (!(now[k] > kRounding * now.back())) continue;
      const double gained = std::sqrt(now[k]) - std::sqrt(std::max(0.0, before[k]));
      error = std::max(error, gained * last / now[k]);
    }
    return error / first;
  }

  // `vectors` of S^t S a row each, `values` rising.
  void settle(const std::vector<double>& range, const Scores& scores,
              const std::vector<double>& vectors, std::vector<double> values) {
    const Index l = columns_;
    std::reverse(values.begin(), values.end());
    for (double& v : values) v = std::max(v, 0.0);
    choose(values, moments_.energy(m_, offset_, svd_.weight));
    const Index k = svd_.rank;
    std::vector<double> rotation(static_cast<std::size_t>(l * k)),
        basis(static_cast<std::size_t>(n_ * k));
    for (Index i = 0; i < l; ++i)
      for (Index j = 0; j < k; ++j) rotation[i * k + j] = vectors[(l - 1 - j) * l + i];
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n_, k, l, 1.0, range.data(), l,
                rotation.data(), k, 0.0, basis.data(), k);
    const std::vector<double> signs = setBasis(basis);
    std::vector<float> turned(rotation.size());
    for (std::size_t i = 0; i < turned.size(); ++i)
      turned[i] = static_cast<float>(rotation[i] * signs[i % k]);
    svd_.scores = scores.rotated(turned, k);
  }

  // The second pass: T's texels, centred and weighed, on the columns of `basis` [n][l].
  Scores scoresOn(const std::vector<double>& basis, const Pass& second) {
    const Index l = static_cast<Index>(basis.size()) / n_;
    std::vector<float> projection(basis.size()), offset(static_cast<std::size_t>(l));
    std::vector<double> sum(static_cast<std::size_t>(l));
    for (Index j = 0; j < n_; ++j)
      for (Index k = 0; k < l; ++k) {
        projection[j * l + k] = static_cast<float>(svd_.weight[j] * basis[j * l + k]);
        sum[k] += offset_[j] * projection[j * l + k];
      }
    std::copy(sum.begin(), sum.end(), offset.begin());
    Scores scores(m_, l);
    second([&](Index first, const SampleBlock& block) {
      scores.add(first, block, n_, projection, offset);
    });
    return scores;
  }

  // Rank and errors from the squares of the singular values.
  void choose(std::span<const double> energies, double total) {
    svd_.rank = options_.rank;
    bool chosen = false;
    double left = total;
    for (std::size_t k = 0; k < energies.size(); ++k) {
      svd_.singular_values.push_back(std::sqrt(energies[k]));
      left -= energies[k];
      svd_.error_of_rank.push_back(total > 0 ? std::sqrt(std::max(0.0, left) / total) : 0);
      if (!chosen && options_.rank_error > 0 && svd_.error_of_rank.back() < options_.rank_error) {
        svd_.rank = std::min<int>(options_.rank, static_cast<int>(k) + 1);
        chosen = true;
      }
    }
    svd_.relative_error = svd_.error_of_rank[static_cast<std::size_t>(svd_.rank) - 1];
  }

  // With a sign that does not hang on the LAPACK at hand; returns each column's.
  std::vector<double> setBasis(const std::vector<double>& basis) {
    const Index rank = svd_.rank;
    std::vector<double> signs;
    svd_.basis.resize(basis.size());
    for (Index k = 0; k < rank; ++k) {
      double largest = 0;
      for (Index j = 0; j < n_; ++j)
        if (std::abs(basis[j * rank + k]) > std::abs(largest)) largest = basis[j * rank + k];
      signs.push_back(largest < 0 ? -1 : 1);
      for (Index j = 0; j < n_; ++j)
        svd_.basis[j * rank + k] = static_cast<float>(signs.back() * basis[j * rank + k]);
    }
    return signs;
  }

  static constexpr double kRounding = 1e-10;  // of squares: below, there is nothing to find

  Index m_, n_, columns_ = 0;
  const SvdOptions& options_;
  Moments moments_;
  std::vector<double> offset_;
  std::optional<GramMatrix> gram_;
  std::optional<RangeSketch> sketch_;
  TemporalSvd svd_;
};

TemporalSvd decompose(Index m, Index n, const SvdOptions& options, Progress& progress,
                      const std::function<SampleBlock(Index first, Index count)>& load) {
  options.check(m, n);
  // One thread inside BLAS, many around it: otherwise sums are cut by the number of threads.
  openblas_set_num_threads(1);
  const Index block = std::max<Index>(1, std::min({options.block_texels, kBlockFloats / n, m}));
  const auto pass = [&](const char* stage) -> Pass {
    return [&, stage](const UseBlock& use) {
      progress.begin(stage, m);
      for (Index first = 0; first < m; first += block) {
        const Index count = std::min(block, m - first);
        use(first, load(first, count));
        progress.step(count);
      }
    };
  };
  return Decomposition(m, n, options)
      .run(pass("correlation of frames"), pass("time-varying coefficients"));
}

}  // namespace

void SvdOptions::check(std::int64_t m, std::int64_t n) const {
  const auto refuse = [](const std::string& what) {
    throw ProcessingError(Exit::kUsage, "singular value decomposition: " + what);
  };
  if (m < 1 || n < 1 || n > 100000)
    refuse("matrix is " + std::to_string(m) + " x " + std::to_string(n) +
           "; allowed: at least 1 row, 1 to 100000 columns");
  if (rank < 1 || rank > std::min(m, n))
    refuse("rank is " + std::to_string(rank) + "; allowed: 1 to " + std::to_string(std::min(m, n)));
  if (!(rank_error >= 0 && rank_error < 1))
    refuse("rank_error is " + std::to_string(rank_error) + "; allowed: 0 to below 1");
  if (block_texels < 1)
    refuse("block_texels is " + std::to_string(block_texels) + "; allowed: at least 1");
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const SampleSource& samples,
                        const SvdOptions& options, Progress& progress) {
  std::vector<float> block;
  return decompose(m, n, options, progress, [&](Index first, Index count) {
    block.resize(static_cast<std::size_t>(count * n));
    samples(first, count, block);
    return SampleBlock{block.data(), count, count};
  });
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, std::span<const float> samples,
                        const SvdOptions& options, Progress& progress) {
  PATINA_CHECK(static_cast<Index>(samples.size()) == m * n);
  return decompose(m, n, options, progress, [&](Index first, Index count) {
    return SampleBlock{samples.data() + first, count, m};
  });
}

}  // namespace patina::decomposition
