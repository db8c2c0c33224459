// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/multi_light_fit.h"

#include <array>
#include <atomic>
#include <cmath>

#include "processing/brdf/anisotropic_fit.h"
#include "processing/brdf/fit_check.h"
#include "processing/brdf/fit_maps.h"
#include "processing/brdf/ggx.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

using lanes::Equations;
using lanes::Estimate;
using lanes::kLanes;
using lanes::Lane;
using lanes::Prior;
using lanes::Samples;

constexpr float kWideLogR = -1.2f, kWideLogRWeight = 0.4f;  // of a texel nobody knows: e^-1.2
constexpr float kWideSpecular = 0.04f, kWideSpecularWeight = 4;
constexpr float kChromaWeight = 100;  // holds specular channels to their mean
constexpr float kBlack = 1e-4f;
constexpr int kFewest = 4;

// One row's sixteen texels from `x0` on; those beyond the edge repeat the last.
class Tile {
 public:
  Tile(const std::vector<FitSample>& samples, const MultiLightOptions& options)
      : from_(samples),
        options_(options),
        size_(samples[0].picture.size()),
        channels_(samples[0].picture.channels),
        lanes_(samples.size()) {
    for (std::size_t i = 0; i < samples.size(); ++i) lanes_.view[i] = samples[i].view;
  }

  Samples& lanes() { return lanes_; }
  int channels() const { return channels_; }
  int column(int x0, int k) const { return std::min(x0 + k, size_.width - 1); }

  void load(int x0, int y) {
    for (std::size_t i = 0; i < from_.size(); ++i) {
      const FitSample& sample = from_[i];
      LightRay ray = rayAt(sample.light, sample.view, 0, 0);
      for (int k = 0; k < kLanes; ++k) {
        const int x = column(x0, k);
        if (sample.light.near) {
          const PlaceMm place = placeOf(x, y, size_, options_.mm_per_texel);
          ray = rayAt(sample.light, sample.view, place.x, place.y);
        }
        put(i, k, ray);
        putLevel(i, k, sample.picture.texel(x, y));
      }
    }
  }

 private:
  void put(std::size_t i, int k, const LightRay& ray) {
    lanes_.lx[i][k] = ray.l.x;
    lanes_.ly[i][k] = ray.l.y;
    lanes_.lz[i][k] = ray.l.z;
    lanes_.hx[i][k] = ray.h.x;
    lanes_.hy[i][k] = ray.h.y;
    lanes_.hz[i][k] = ray.h.z;
    lanes_.v_h[i][k] = ray.v_h;
    lanes_.m[i][k] = options_.model == Model::kGgx ? schlickWeight(ray.v_h) : 0.0f;
    lanes_.e[i][k] = ray.irradiance;
  }

  void putLevel(std::size_t i, int k, std::span<const float> texel) {
    float sum = 0;
    bool usable = lanes_.e[i][k] > 0;
    for (const float v : texel) {
      usable = usable && v < options_.saturated && v > -1.0f;  // NaN fails both
      sum += v;
    }
    const float level = usable ? sum / static_cast<float>(texel.size()) : 0;
    const FitNoise& noise = options_.noise;
    const float above = std::max(level, 0.0f);
    const float variance =
        noise.floor * noise.floor + noise.shot * above + noise.gain * noise.gain * above * above;
    lanes_.y[i][k] = level;
    lanes_.noise[i][k] = usable ? 1 / variance : 0;
  }

  const std::vector<FitSample>& from_;
  const MultiLightOptions& options_;
  SizePx size_;
  int channels_;
  Samples lanes_;
};

// 1 / variance that the data alone give: the priors' own share is taken off again.
struct Counts {
  std::int64_t black = 0, few = 0, levels = 0, used = 0;
  double square = 0;
};

class Fitter {
 public:
  Fitter(const std::vector<FitSample>& samples, const MultiLightOptions& options)
      : samples_(samples),
        options_(options),
        state_(samples[0].picture.size(), samples[0].picture.channels),
        rows_(static_cast<std::size_t>(state_.size.height)) {}

  FitState& state() { return state_; }

  void firstPass(Progress& progress) {
    // The passes after this one are rounds too.
    MultiLightOptions first = options_;
    if (options_.neighbours) first.rounds = std::max(1, options_.rounds - 1);
    progress.begin("reflectance", state_.size.height);
    forEachTile(
        [&](Tile& tile, int x0, int y) {
          Estimate at;
          tile.load(x0, y);
          lanes::photometricStart(tile.lanes(), at);
          Prior prior = widePrior();
          Equations q;
          if (glossy()) {
            lanes::scanRoughness(options_.model, tile.lanes(), at, prior);
            lanes::refine(first, tile.lanes(), at, prior, q);
          } else {
            matt(tile.lanes(), at, q);
          }
          keep(tile, at, q, prior, nullptr, x0, y);
          if (glossy()) keepCurves(tile, at, prior, x0, y);
        },
        progress);
  }

  // Once more from where the texels are, held to `maps`.
  void again(const PriorMaps& maps, Progress& progress) {
    progress.begin("reflectance again", state_.size.height);
    forEachTile(
        [&](Tile& tile, int x0, int y) {
          tile.load(x0, y);
          Prior prior = widePrior();
          Estimate at = startAgain(tile, maps, prior, x0, y);
          Equations q;
          for (std::size_t i = 0; i < samples_.size(); ++i)
            tile.lanes().weight[i] = tile.lanes().noise[i];
          const Estimate known = at;  // whose kd and ks no shadow has spoilt
          lanes::evaluate(options_.model, tile.lanes(), at, prior, q);
          lanes::reweigh(tile.lanes(), known);
          MultiLightOptions once = options_;
          once.rounds = 1;
          lanes::refine(once, tile.lanes(), at, prior, q);
          keep(tile, at, q, prior, &maps, x0, y);
        },
        progress);
  }

  MultiLightReport report() const {
    MultiLightReport report;
    Counts sum;
    for (const Counts& row : rows_) {
      sum.black += row.black;
      sum.few += row.few;
      sum.levels += row.levels;
      sum.used += row.used;
      sum.square += row.square;
    }
    report.texels = std::int64_t{state_.size.width} * state_.size.height;
    report.black = sum.black;
    report.few = sum.few;
    for (const float c : state_.confidence.texels()) report.confident += c >= 0.5f;
    report.residual_rms =
        std::sqrt(sum.square / static_cast<double>(std::max<std::int64_t>(1, sum.used)));
    report.left_out = 1 - static_cast<double>(sum.used) /
                              static_cast<double>(std::max<std::int64_t>(1, sum.levels));
    return report;
  }

 private:
  bool glossy() const { return options_.model != Model::kLambert; }

  static Prior widePrior() {
    Prior prior;
    for (int k = 0; k < kLanes; ++k) {
      prior.u[k] = kWideLogR;
      prior.u_weight[k] = kWideLogRWeight;
      prior.ks[k] = kWideSpecular;
      prior.ks_weight[k] = kWideSpecularWeight;
    }
    return prior;
  }

  template <class Body>
  void forEachTile(const Body& body, Progress& progress) {
    forEachRow(state_.size.height, std::int64_t{state_.size.width} * 4000, [&](int y) {
      Tile tile(samples_, options_);
      rows_[static_cast<std::size_t>(y)] = {};
      for (int x0 = 0; x0 < state_.size.width; x0 += kLanes) body(tile, x0, y);
      progress.step();
    });
  }

  Estimate startAgain(const Tile& tile, const PriorMaps& maps, Prior& prior, int x0, int y) const {
    Estimate at;
    for (int k = 0; k < kLanes; ++k) {
      const int x = tile.column(x0, k);
      const auto n = state_.normal.view().texel(x, y);
      at.nx[k] = n[0], at.ny[k] = n[1], at.nz[k] = std::max(n[2], 0.05f);
      at.u[k] = state_.log_r.at(x, y);
      at.kd[k] = state_.grey_diffuse.at(x, y);
      at.ks[k] = state_.grey_specular.at(x, y);
      const float known = maps.log_r_weight.at(x, y);
      if (!(known > 0)) continue;
      prior.u[k] = maps.log_r.at(x, y);
      prior.u_weight[k] += known;
      const float gloss = maps.specular_weight.at(x, y);
      if (!(gloss > 0)) {
        at.u[k] = prior.u[k];
        continue;
      }
      prior.ks_weight[k] += gloss;
      prior.ks[k] = 0;
      for (const float v : maps.specular.view().texel(x, y))
        prior.ks[k] += v / static_cast<float>(maps.specular.channels());
    }
    return at;
  }

  // The diffuse part alone, from the normal at hand.
  static void matt(Samples& s, Estimate& at, Equations& q) {
    for (int round = 0; round < 2; ++round) {
      q = Equations{};
      for (int k = 0; k < kLanes; ++k) {
        float ay = 0;
        for (std::size_t i = 0; i < s.count; ++i) {
          const float n_l = at.nx[k] * s.lx[i][k] + at.ny[k] * s.ly[i][k] + at.nz[k] * s.lz[i][k];
          s.a[i][k] = s.e[i][k] * std::max(n_l, 0.0f);
          s.g[i][k] = 0;
          q.aa[k] += s.weight[i][k] * s.a[i][k] * s.a[i][k];
          ay += s.weight[i][k] * s.a[i][k] * s.y[i][k];
        }
        at.kd[k] = q.aa[k] > 0 ? std::max(ay / q.aa[k], 0.0f) : 0;
        at.ks[k] = 0;
      }
      if (round == 0) lanes::reweigh(s, at);
    }
  }

  void keep(Tile& tile, const Estimate& at, const Equations& q, const Prior& prior,
            const PriorMaps* maps, int x0, int y) {
    for (int k = 0; k < kLanes && x0 + k < state_.size.width; ++k)
      keepTexel(tile, at, q, prior, maps, x0 + k, y, k);
  }

  void keepCurves(Tile& tile, const Estimate& at, const Prior& prior, int x0, int y) {
    Lane curve[lanes::kCurve];
    lanes::costCurve(options_.model, tile.lanes(), at, prior, curve);
    const Samples& s = tile.lanes();
    for (int k = 0; k < kLanes && x0 + k < state_.size.width; ++k) {
      int used = 0;
      float least = curve[0][k];
      for (std::size_t i = 0; i < s.count; ++i) used += s.weight[i][k] > 0;
      for (const Lane& cost : curve) least = std::min(least, cost[k]);
      const float spread2 = std::max(1.0f, least / static_cast<float>(std::max(used - 4, 1)));
      for (int j = 0; j < lanes::kCurve; ++j)
        state_.curve.at(x0 + k, y, j) = (curve[j][k] - least) / spread2;
      keepLook(s, x0 + k, y, k);
    }
  }

  // Levels that count over the diffuse part's irradiance.
  void keepLook(const Samples& s, int x, int y, int k) {
    float lit = 0;
    const auto look = state_.look.view().texel(x, y);
    for (std::size_t i = 0; i < s.count; ++i) {
      if (!(s.weight[i][k] > 0)) continue;
      lit += s.a[i][k];
      const auto texel = samples_[i].picture.texel(x, y);
      for (std::size_t c = 0; c < look.size(); ++c) look[c] += texel[c];
    }
    for (float& v : look) v /= std::max(lit, 1e-6f);
  }

  void keepTexel(Tile& tile, const Estimate& at, const Equations& q, const Prior& prior,
                 const PriorMaps* maps, int x, int y, int k) {
    Counts& counts = rows_[static_cast<std::size_t>(y)];
    const Samples& s = tile.lanes();
    int usable = 0, used = 0;
    float brightest = 0;
    double square = 0, chi = 0;
    for (std::size_t i = 0; i < s.count; ++i) {
      usable += s.noise[i][k] > 0;
      brightest = std::max(brightest, s.y[i][k]);
      if (!(s.weight[i][k] > 0)) continue;
      ++used;
      const float m = s.m[i][k];
      const double off = s.y[i][k] - at.kd[k] * s.a[i][k] - (at.ks[k] * (1 - m) + m) * s.g[i][k];
      square += off * off;
      chi += off * off * s.weight[i][k];
    }
    counts.levels += static_cast<std::int64_t>(s.count);
    counts.used += used;
    counts.square += square;
    state_.residual.at(x, y) = static_cast<float>(std::sqrt(square / std::max(used, 1)));
    auto n = state_.normal.view().texel(x, y);
    const bool black = brightest < kBlack;
    counts.black += black;
    counts.few += !black && usable < kFewest;
    if (black) {
      n[0] = n[1] = 0, n[2] = 1;
      state_.log_r.at(x, y) = kWideLogR;
      return;
    }
    n[0] = at.nx[k], n[1] = at.ny[k], n[2] = at.nz[k];
    state_.log_r.at(x, y) = at.u[k];
    state_.grey_diffuse.at(x, y) = at.kd[k];
    state_.grey_specular.at(x, y) = at.ks[k];
    const double spread2 = std::max(1.0, chi / std::max(used - 5, 1));
    const bool enough = used >= 6 && usable >= kFewest && glossy();
    const lanes::Certainty certainty =
        enough ? lanes::certaintyOf(at, q, prior, spread2, k) : lanes::Certainty{};
    state_.confidence.at(x, y) = static_cast<float>(certainty.confidence);
    state_.specular_weight.at(x, y) = static_cast<float>(certainty.specular_weight);
    keepColours(tile, at, q, prior, maps, x, y, k);
  }

  void keepColours(Tile& tile, const Estimate& at, const Equations& q, const Prior& prior,
                   const PriorMaps* maps, int x, int y, int k) {
    const Samples& s = tile.lanes();
    const float known = maps ? maps->specular_weight.at(x, y) : 0;
    for (int c = 0; c < tile.channels(); ++c) {
      const float alike = known > 0 ? maps->specular.at(x, y, c) : prior.ks[k];
      float ay = 0, by = 0;
      for (std::size_t i = 0; i < s.count; ++i) {
        if (!(s.weight[i][k] > 0)) continue;
        const float m = s.m[i][k], rest = samples_[i].picture.at(x, y, c) - m * s.g[i][k];
        ay += s.weight[i][k] * s.a[i][k] * rest;
        by += s.weight[i][k] * (1 - m) * s.g[i][k] * rest;
      }
      float kd = 0, ks = 0;
      if (glossy())
        lanes::solveLinear(q.aa[k], q.ab[k], q.bb[k] + kChromaWeight, ay,
                           by + prior.ks_weight[k] * alike + kChromaWeight * at.ks[k], kd, ks);
      else
        kd = q.aa[k] > 0 ? std::max(ay / q.aa[k], 0.0f) : 0;
      state_.diffuse.at(x, y, c) = kd;
      state_.specular.at(x, y, c) = ks;
    }
  }

  const std::vector<FitSample>& samples_;
  const MultiLightOptions& options_;
  FitState state_;
  std::vector<Counts> rows_;
};

void holdToNeighbours(Fitter& fitter, const std::vector<FitBefore>& before,
                      const MultiLightOptions& options, Progress& progress) {
  PriorMaps prior(fitter.state().size, fitter.state().specular.channels());
  poolRoughness(fitter.state(), before, options, prior, progress);
  fitter.again(prior, progress);
  poolSpecular(fitter.state(), before, options, prior, progress);
  fitter.again(prior, progress);
}

}  // namespace

MultiLightFit fitManyLights(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                            const std::vector<FitBefore>& before, Progress& progress) {
  options.check();
  checkSamples(samples, options, before);
  MultiLightOptions first = options;
  if (options.model == Model::kWardAnisotropic) first.model = Model::kWard;
  Fitter fitter(samples, first);
  fitter.firstPass(progress);
  if (options.model != Model::kLambert && (options.neighbours || !before.empty()))
    holdToNeighbours(fitter, before, first, progress);
  MultiLightFit fit;
  fit.report = fitter.report();
  FitState& state = fitter.state();
  fit.maps.diffuse = std::move(state.diffuse);
  fit.maps.normal = std::move(state.normal);
  fit.maps.extra["Residual"] = std::move(state.residual);
  if (options.model == Model::kLambert) return fit;
  fit.maps.specular = std::move(state.specular);
  for (float& r : state.log_r.texels()) r = std::exp(r);
  fit.maps.roughness = std::move(state.log_r);
  fit.maps.extra["Confidence"] = std::move(state.confidence);
  if (options.model == Model::kWardAnisotropic) splitRoughness(samples, options, fit, progress);
  return fit;
}

}  // namespace patina::brdf
