// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/temporal_svd.h"

#include <cblas.h>
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
constexpr int kLearning = 2;              // iterations on the first block
constexpr int kRounds = 4;                // at most, a pass each
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
      const Index row = static_cast<Index>(j) * block.stride;
      if (block.codes)
        return addCodes(block.codes + row, block.count, block.step, sum_[j], squares_[j]);
      for (Index first = 0; first < block.count; first += kRun)
        addRun(block.data + row + first, std::min(kRun, block.count - first), sum_[j], squares_[j]);
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
  static constexpr Index kRun = 512;        // in float
  static constexpr Index kCodes = 1 << 15;  // whose squares 32 bits can hold
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
  static void addCodes(const std::uint8_t* codes, Index count, double step, double& sum,
                       double& squares) {
    for (Index first = 0; first < count; first += kCodes) {
      std::uint32_t s = 0, q = 0;
      for (Index i = first; i < std::min(count, first + kCodes); ++i) {
        s += codes[i];
        q += std::uint32_t{codes[i]} * codes[i];
      }
      sum += step * s;
      squares += step * step * q;
    }
  }
  std::vector<double> sum_, squares_;
};

// One decomposition. Through the Gram matrix: a pass for it and one for the scores. Through a
// sketch: one pass, and another from what was found where it was not found well enough.
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
      if (at == 0) sketch_.emplace(m_, n_, learned(block));
      sketch_->add(at, block);
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
      bySketch(second);
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
      RangeSketch sketch(block.count, n_, std::move(omega));
      sketch.add(0, block);
      omega = unweighed(sketch.factors(mean, weight).basis, weight);
    }
    // Across the others: of a column of chance, what they hold would drown the rest.
    const Index known = columns_ - kUnlearned;
    for (Index k = known; k < columns_; ++k) {
      std::vector<double> column(static_cast<std::size_t>(n_));
      for (Index j = 0; j < n_; ++j) column[j] = random[j * columns_ + k] / std::sqrt(n_);
      for (Index i = 0; i < known; ++i) {
        double along = 0, length = 0;
        for (Index j = 0; j < n_; ++j) {
          along += omega[j * columns_ + i] * column[j];
          length += double{omega[j * columns_ + i]} * omega[j * columns_ + i];
        }
        if (!(length > 0)) continue;
        for (Index j = 0; j < n_; ++j) column[j] -= along / length * omega[j * columns_ + i];
      }
      for (Index j = 0; j < n_; ++j)
        omega[j * columns_ + k] = static_cast<float>(weight[j] * column[j]);
    }
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
    svd_.scores = scoresOnBasis(second).byTexel();
  }

  void bySketch(const Pass& again) {
    for (int round = 1;; ++round) {
      const RangeSketch::Factors factors = sketch_->factors(offset_, svd_.weight);
      if (round == kRounds || errorOf(factors) <= options_.certain) return settle(factors);
      sketch_.emplace(m_, n_, unweighed(factors.basis, svd_.weight));
      again([&](Index first, const SampleBlock& block) { sketch_->add(first, block); });
    }
  }

  // How far the singular values up to the rank may be off, of the first. A step, half of one by
  // T^t T, leaves of their squares' errors a share below (s_l / s_k)^2, and takes what is gained
  // over `squares_on_omega`; the root of that share is reckoned with, since not all columns have
  // converged.
  double errorOf(const RangeSketch::Factors& f) const {
    const double first = std::sqrt(f.squares.front()), last = std::sqrt(f.squares.back());
    double error = 0;
    for (int k = 0; k < options_.rank; ++k) {
      const double s = std::sqrt(f.squares[k]);
      if (!(s > kNothing * first)) continue;
      const double gained = s - std::sqrt(std::max(0.0, f.squares_on_omega[k]));
      error = std::max(error, gained * last / s);
    }
    return first > 0 ? error / first : 0;
  }

  void settle(const RangeSketch::Factors& f) {
    choose(f.squares, moments_.energy(m_, offset_, svd_.weight));
    const Index l = columns_, k = svd_.rank;
    std::vector<double> basis(static_cast<std::size_t>(n_ * k));
    for (Index j = 0; j < n_; ++j)
      for (Index i = 0; i < k; ++i) basis[j * k + i] = f.basis[j * l + i];
    const std::vector<double> signs = setBasis(basis);
    std::vector<float> turned(static_cast<std::size_t>(l * k));
    for (Index i = 0; i < l; ++i)
      for (Index j = 0; j < k; ++j)
        turned[i * k + j] = static_cast<float>(f.rotation[i * l + j] * signs[j]);
    svd_.scores = sketch_->scores().rotated(turned, k);
  }

  // The second pass: T's texels, centred and weighed, on the basis.
  Scores scoresOnBasis(const Pass& second) const {
    const Index l = svd_.rank;
    std::vector<float> vectors(svd_.basis.size());
    std::vector<double> offset(static_cast<std::size_t>(l));
    for (Index j = 0; j < n_; ++j)
      for (Index k = 0; k < l; ++k) {
        vectors[j * l + k] = svd_.weight[j] * svd_.basis[j * l + k];
        offset[k] += offset_[j] * vectors[j * l + k];
      }
    Scores scores(m_, l);
    second([&](Index first, const SampleBlock& block) { scores.add(first, block, n_, vectors); });
    scores.subtract(offset);
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

  static constexpr double kNothing = 1e-5;  // of the first singular value: all is rounding

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
  Index block = std::max<Index>(1, std::min({options.block_texels, kBlockFloats / n, m}));
  if (block > kPanelTexels) block -= block % kPanelTexels;  // whole ones are quicker
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
  if (!(certain > 0)) refuse("certain is " + std::to_string(certain) + "; allowed: above 0");
  if (block_texels < 1)
    refuse("block_texels is " + std::to_string(block_texels) + "; allowed: at least 1");
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const SampleSource& samples,
                        const SvdOptions& options, Progress& progress) {
  std::vector<float> block;
  return decompose(m, n, options, progress, [&](Index first, Index count) {
    block.resize(static_cast<std::size_t>(count * n));
    samples(first, count, block);
    return SampleBlock{.data = block.data(), .count = count, .stride = count};
  });
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, const CodeSource& codes, float step,
                        const SvdOptions& options, Progress& progress) {
  std::vector<std::uint8_t> block;
  return decompose(m, n, options, progress, [&](Index first, Index count) {
    block.resize(static_cast<std::size_t>(count * n));
    codes(first, count, block);
    return SampleBlock{.codes = block.data(), .step = step, .count = count, .stride = count};
  });
}

TemporalSvd temporalSvd(std::int64_t m, std::int64_t n, std::span<const float> samples,
                        const SvdOptions& options, Progress& progress) {
  PATINA_CHECK(static_cast<Index>(samples.size()) == m * n);
  return decompose(m, n, options, progress, [&](Index first, Index count) {
    return SampleBlock{.data = samples.data() + first, .count = count, .stride = m};
  });
}

}  // namespace patina::decomposition
