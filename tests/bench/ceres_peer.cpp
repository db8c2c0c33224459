// SPDX-License-Identifier: GPL-3.0-or-later
// The fit of brdf_bench.cpp beside Ceres, texel by texel: nine parameters, slopes by automatic
// differentiation, dense QR. Built on demand (-D PATINA_CERES_PEER=ON), since nothing else needs
// it.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "processing/brdf/ggx.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

constexpr int kLights = 24, kSide = 48;

const LitSurface& surface() {
  static const LitSurface kept =
      lit(rollingMaps(kSide, kSide, {0.15f, 0.3f}), Model::kGgx, dome(kLights));
  return kept;
}

// 1 / sigma of a picture's level: the mean of the channels, as the fit has it.
double certaintyAt(const FitSample& sample, int x, int y) {
  const FitNoise noise = calmOptions().noise;
  double level = 0;
  for (int c = 0; c < 3; ++c) level += sample.picture.at(x, y, c) / 3.0;
  level = std::max(level, 0.0);
  return 1 / std::sqrt(double{noise.floor} * noise.floor + noise.shot * level +
                       double{noise.gain} * noise.gain * level * level);
}

// RMS of all channels that a fit leaves, in units of the noise, as the solver's is.
double leftBy(const MultiLightFit& fit) {
  BrdfSetInfo info;
  info.model = Model::kGgx;
  double square = 0, levels = 0;
  for (const FitSample& sample : surface().samples) {
    const Image<float> lit_again = relight(fit.maps, info, sample.light);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int c = 0; c < 3; ++c, ++levels) {
          const double off = (double{lit_again.at(x, y, c)} - sample.picture.at(x, y, c)) *
                             certaintyAt(sample, x, y);
          square += off * off;
        }
  }
  return std::sqrt(square / levels);
}

void BM_ManyLights(benchmark::State& state) {
  MultiLightOptions options = calmOptions();
  options.neighbours = false;
  MultiLightFit fit;
  for (auto _ : state) {
    Progress progress;
    fit = fitManyLights(surface().samples, options, {}, progress);
  }
  state.counters["residual_rms"] = leftBy(fit);
}

// Parameters: slopes p and q of the normal, ln of alpha, kd and ks of three channels. Of the lights
// from `first` on.
struct Residuals {
  int x, y, first, lights;
  template <class T>
  bool operator()(const T* p, T* off) const {
    const T nz = 1.0 / sqrt(1.0 + p[0] * p[0] + p[1] * p[1]), nx = p[0] * nz, ny = p[1] * nz;
    const T a2 = exp(2.0 * p[2]);
    for (int i = 0; i < lights; ++i) {
      const FitSample& sample = surface().samples[static_cast<std::size_t>(first + i)];
      const Vec3& l = sample.light.direction;
      const Vec3 h = halfway(l, {0, 0, 1});
      T n_l = nx * double{l.x} + ny * double{l.y} + nz * double{l.z};
      if (n_l < 1e-3) n_l = T(1e-3);
      const T n_h = nx * double{h.x} + ny * double{h.y} + nz * double{h.z};
      const T q = n_h * n_h * (a2 - 1.0) + 1.0;
      const T lobe =
          a2 / (M_PI * q * q) * 0.5 /
          (nz * sqrt(n_l * n_l * (1.0 - a2) + a2) + n_l * sqrt(nz * nz * (1.0 - a2) + a2));
      const double m = schlickWeight(h.z), certainty = certaintyAt(sample, x, y);
      for (int c = 0; c < 3; ++c)
        off[3 * i + c] = certainty * (double{sample.picture.at(x, y, c)} -
                                      (p[3 + c] + M_PI * lobe * (p[6 + c] * (1 - m) + m)) * n_l);
    }
    return true;
  }
};

enum class Loss { kSquares, kCauchy };  // the latter as the fit's: 2.4 sigmas, a light at a time

// The cost reached from one start; `p` holds where.
double solved(int x, int y, Loss loss, double* p) {
  ceres::Problem problem;
  if (loss == Loss::kSquares)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Residuals, 3 * kLights, 9>(new Residuals{x, y, 0, kLights}),
        nullptr, p);
  else
    for (int i = 0; i < kLights; ++i)
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Residuals, 3, 9>(new Residuals{x, y, i, 1}),
          new ceres::CauchyLoss(2.4), p);
  problem.SetParameterLowerBound(p, 2, std::log(0.02));  // as the fit's
  problem.SetParameterUpperBound(p, 2, 0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 100;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return 2 * summary.final_cost;
}

// What `p` leaves, without any loss.
double squaresAt(int x, int y, const double* p) {
  std::array<double, std::size_t{3} * kLights> off{};
  Residuals{x, y, 0, kLights}(p, off.data());
  double square = 0;
  for (const double v : off) square += v * v;
  return square;
}

// A Lambert surface by least squares: where a solver would begin.
Eigen::Vector3d lambertNormal(int x, int y) {
  Eigen::Matrix<double, kLights, 3> directions;
  Eigen::Matrix<double, kLights, 1> levels;
  for (int i = 0; i < kLights; ++i) {
    const FitSample& sample = surface().samples[static_cast<std::size_t>(i)];
    const Vec3& l = sample.light.direction;
    directions.row(i) << l.x, l.y, l.z;
    levels[i] = sample.picture.at(x, y, 1);
  }
  Eigen::Vector3d n =
      (directions.transpose() * directions).ldlt().solve(directions.transpose() * levels);
  n.z() = std::max(n.z(), 0.1 * n.norm());
  return n;
}

// The best from so many values of alpha; with few the solver ends in minima of their own.
void ceresFits(benchmark::State& state, Loss loss) {
  const std::vector<double> all{0.25, 0.12, 0.5, 0.06};
  double square = 0;
  for (auto _ : state) {
    square = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Eigen::Vector3d n = lambertNormal(x, y);
        double best = INFINITY, left = 0;
        for (int start = 0; start < state.range(0); ++start) {
          double p[9] = {
              n.x() / n.z(), n.y() / n.z(), std::log(all[static_cast<std::size_t>(start)]),
              0.3,           0.3,           0.3,
              0.05,          0.05,          0.05};
          const double cost = solved(x, y, loss, p);
          if (cost < best) best = cost, left = squaresAt(x, y, p);
        }
        square += left;
      }
  }
  state.counters["residual_rms"] =
      std::sqrt(square / (static_cast<double>(kSide) * kSide * 3 * kLights));
}

void BM_Ceres(benchmark::State& state) { ceresFits(state, Loss::kSquares); }
void BM_CeresRobust(benchmark::State& state) { ceresFits(state, Loss::kCauchy); }

BENCHMARK(BM_ManyLights)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(BM_Ceres)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

BENCHMARK(BM_CeresRobust)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace patina::brdf

BENCHMARK_MAIN();
