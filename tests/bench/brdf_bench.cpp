// SPDX-License-Identifier: GPL-3.0-or-later
// The fit of 512x512 texels under 24 lights (GGX, normals), beside a general solver on the same
// problem texel by texel: MINPACK's Levenberg-Marquardt as Eigen's unsupported module ships it,
// nine parameters, slopes by forward differences. Ceres stays away: Debian's brings ATLAS along.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "processing/brdf/ggx.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

constexpr int kLights = 24;

const LitSurface& surfaceOf(int size) {
  static std::map<int, LitSurface> kept;
  const auto at = kept.find(size);
  if (at != kept.end()) return at->second;
  return kept.emplace(size, lit(rollingMaps(size, size, {0.15f, 0.3f}), Model::kGgx, dome(kLights)))
      .first->second;
}

void BM_ManyLights(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const LitSurface& surface = surfaceOf(size);
  MultiLightOptions options = calmOptions();
  options.neighbours = state.range(1) != 0;
  double residual = 0;
  for (auto _ : state) {
    Progress progress;
    residual = fitManyLights(surface.samples, options, {}, progress).report.residual_rms;
  }
  state.counters["residual_rms"] = residual;
  state.counters["texels/s"] = benchmark::Counter(static_cast<double>(size) * size,
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

// Parameters: slopes p and q of the normal, ln of alpha, kd and ks of three channels.
struct Problem {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  const LitSurface* surface = nullptr;
  int x = 0, y = 0;
  int inputs() const { return 9; }
  int values() const { return 3 * kLights; }

  // D V of ggx.h, in double precision as a general solver's differences need it.
  static double lobe(double n_l, double n_v, double n_h, double alpha) {
    const double a2 = alpha * alpha, q = n_h * n_h * (a2 - 1) + 1;
    const double root_l = std::sqrt(n_l * n_l * (1 - a2) + a2),
                 root_v = std::sqrt(n_v * n_v * (1 - a2) + a2);
    return a2 / (M_PI * q * q) * 0.5 / (n_v * root_l + n_l * root_v);
  }

  int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& off) const {
    const double nz = 1 / std::sqrt(1 + p[0] * p[0] + p[1] * p[1]);
    const double nx = p[0] * nz, ny = p[1] * nz, alpha = std::exp(p[2]);
    for (int i = 0; i < kLights; ++i) {
      const FitSample& sample = surface->samples[static_cast<std::size_t>(i)];
      const Vec3& l = sample.light.direction;
      const Vec3 h = halfway(l, {0, 0, 1});
      const double n_l = std::max(nx * l.x + ny * l.y + nz * l.z, 1e-3);
      const double value = lobe(n_l, nz, nx * h.x + ny * h.y + nz * h.z, alpha);
      const double m = schlickWeight(h.z);
      for (int c = 0; c < 3; ++c)
        off[3 * i + c] =
            sample.picture.at(x, y, c) - (p[3 + c] + M_PI * value * (p[6 + c] * (1 - m) + m)) * n_l;
    }
    return 0;
  }
};

void BM_GeneralSolver(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const LitSurface& surface = surfaceOf(size);
  double square = 0;
  for (auto _ : state) {
    square = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        Eigen::VectorXd p(9), off(3 * kLights);
        p << 0, 0, std::log(0.25), 0.3, 0.3, 0.3, 0.05, 0.05, 0.05;
        Eigen::NumericalDiff<Problem> problem(Problem{&surface, x, y});
        Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Problem>> solver(problem);
        solver.parameters.ftol = solver.parameters.xtol = 1e-6;
        solver.parameters.maxfev = 400;
        solver.minimize(p);
        problem(p, off);
        square += off.squaredNorm();
      }
  }
  state.counters["residual_rms"] =
      std::sqrt(square / (static_cast<double>(size) * size * 3 * kLights));
  state.counters["texels/s"] = benchmark::Counter(static_cast<double>(size) * size,
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(BM_ManyLights)
    ->Args({512, 1})
    ->Args({512, 0})
    ->Args({48, 0})
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();
BENCHMARK(BM_GeneralSolver)->Arg(48)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace patina::brdf
