// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/multi_light_fit.h"

#include <array>
#include <cmath>

#include "processing/brdf/anisotropic_fit.h"
#include "processing/brdf/fit_check.h"
#include "processing/brdf/fit_maps.h"
#include "processing/brdf/fit_tile.h"
#include "processing/brdf/lane_fit.h"
#include "processing/brdf/roughness_curve.h"
#include "processing/brdf/roughness_pool.h"
#include "processing/brdf/shadow_map.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

using lanes::Equations;
using lanes::Estimate;
using lanes::kLanes;
using lanes::Lane;
using lanes::Prior;
using lanes::Samples;

constexpr float kWideSpecularWeight = 4;
constexpr float kChromaWeight = 100;  // holds specular channels to their mean
constexpr float kShadowedChromaWeight = 1 / (0.02f * 0.02f);  // of what many lamps do not reach
constexpr float kBlack = 1e-4f;
constexpr int kFewest = 4;

float meanOf(std::span<const float> channels) {
  float sum = 0;
  for (const float v : channels) sum += v;
  return sum / static_cast<float>(channels.size());
}

struct Counts {
  std::int64_t black = 0, few = 0, levels = 0, used = 0;
  double square = 0;
};

class Fitter {
 public:
  // `together`: texels will be held to others, by again().
  Fitter(const std::vector<FitSample>& samples, const MultiLightOptions& options, bool together)
      : samples_(samples),
        options_(options),
        together_(together),
        state_(samples[0].picture.size(), samples[0].picture.channels),
        rows_(static_cast<std::size_t>(state_.size.height)) {
    if (options.deep_shadows) shadows_.emplace(state_.size, samples.size());
  }

  FitState& state() { return state_; }

  void firstPass(Progress& progress) {
    // The passes after this one are rounds too.
    MultiLightOptions first = options_;
    if (together_) first.rounds = std::max(1, options_.rounds - 1);
    progress.begin("reflectance", state_.size.height);
    forEachTile(
        [&](FitTile& tile, int x0, int y) {
          Estimate at;
          tile.load(x0, y);
          lanes::photometricStart(tile.lanes(), at);
          const Prior prior = widePrior();
          Equations q;
          if (glossy()) {
            lanes::scanRoughness(options_.model, tile.lanes(), at, prior);
            lanes::refine(first, tile.lanes(), at, prior, q);
            if (options_.deep_shadows) lanes::tryRivals(first, tile.lanes(), at, prior, q);
          } else {
            matt(tile.lanes(), at, q);
          }
          keep(tile, at, q, prior, nullptr, x0, y);
          if (shadows_)
            shadows_->keep(tile.lanes(), x0, y);
          else if (together_)
            keepCurves(tile, at, x0, y);
        },
        progress);
  }

  // Once more without the levels beside shadows' edges.
  void besideShadows(Progress& progress) {
    progress.begin("reflectance beside shadows", state_.size.height);
    forEachTile(
        [&](FitTile& tile, int x0, int y) {
          const Prior prior = widePrior();
          Equations q;
          const Estimate at = refineAgain(tile, nullptr, prior, x0, y, q);
          keep(tile, at, q, prior, nullptr, x0, y);
          if (together_) keepCurves(tile, at, x0, y);
        },
        progress);
  }

  // Once more from where the texels are, held to `maps`.
  void again(const PriorMaps& maps, Progress& progress) {
    progress.begin("reflectance again", state_.size.height);
    forEachTile(
        [&](FitTile& tile, int x0, int y) {
          Prior prior = widePrior();
          hold(prior, maps, tile, x0, y);
          Equations q;
          const Estimate at = refineAgain(tile, &maps, prior, x0, y, q);
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
      prior.ks[k] = kDielectric;
      prior.ks_weight[k] = kWideSpecularWeight;
    }
    return prior;
  }

  template <class Body>
  void forEachTile(const Body& body, Progress& progress) {
    forEachRow(state_.size.height, std::int64_t{state_.size.width} * 4000, [&](int y) {
      FitTile tile(samples_, options_);
      rows_[static_cast<std::size_t>(y)] = {};
      for (int x0 = 0; x0 < state_.size.width; x0 += kLanes) body(tile, x0, y);
      progress.step();
    });
  }

  // To what neighbours tell, where they do.
  void hold(Prior& prior, const PriorMaps& maps, const FitTile& tile, int x0, int y) const {
    for (int k = 0; k < kLanes; ++k) {
      const int x = tile.column(x0, k);
      const float known = maps.log_r_weight.at(x, y), gloss = maps.specular_weight.at(x, y);
      if (!(known > 0)) continue;
      prior.u[k] = maps.log_r.at(x, y);
      prior.u_weight[k] += known;
      prior.ks[k] = maps.expected_specular.at(x, y);
      prior.ks_weight[k] += maps.expected_weight.at(x, y);
      if (!(gloss > 0)) continue;
      const float both = prior.ks_weight[k] + gloss,
                  alike = meanOf(maps.specular.view().texel(x, y));
      prior.ks[k] = (prior.ks_weight[k] * prior.ks[k] + gloss * alike) / both;
      prior.ks_weight[k] = both;
    }
  }

  // From where the texels are; at first with the pools' roughness, where `maps` have no more yet.
  Estimate refineAgain(FitTile& tile, const PriorMaps* maps, const Prior& prior, int x0, int y,
                       Equations& q) const {
    Samples& s = tile.lanes();
    tile.load(x0, y);
    if (shadows_) shadows_->forgetEdges(s, x0, y);
    Estimate at;
    for (int k = 0; k < kLanes; ++k) {
      const int x = tile.column(x0, k);
      const auto n = state_.normal.view().texel(x, y);
      at.nx[k] = n[0], at.ny[k] = n[1], at.nz[k] = std::max(n[2], 0.05f);
      s.shadowed[k] = state_.shadowed.at(x, y) ? 1 : 0;
      const bool pooled =
          maps && maps->log_r_weight.at(x, y) > 0 && !(maps->specular_weight.at(x, y) > 0);
      at.u[k] = pooled ? prior.u[k] : state_.log_r.at(x, y);
      at.kd[k] = state_.grey_diffuse.at(x, y);
      at.ks[k] = state_.grey_specular.at(x, y);
    }
    for (lanes::Light& light : s.light) light.weight = light.noise;
    MultiLightOptions once = options_;
    once.rounds = 1;
    // Weights by kd and ks as they are: no shadow has spoilt them.
    lanes::refine(once, s, at, prior, q, true);
    return at;
  }

  // The diffuse part alone, from the normal at hand.
  static void matt(Samples& s, Estimate& at, Equations& q) {
    for (int round = 0; round < 2; ++round) {
      q = Equations{};
      for (int k = 0; k < kLanes; ++k) {
        float ay = 0;
        for (std::size_t i = 0; i < s.count; ++i) {
          const float n_l = at.nx[k] * s.light[i].lx[k] + at.ny[k] * s.light[i].ly[k] +
                            at.nz[k] * s.light[i].lz[k];
          s.light[i].a[k] = s.light[i].e[k] * std::max(n_l, 0.0f);
          s.light[i].g[k] = 0;
          q.aa[k] += s.light[i].weight[k] * s.light[i].a[k] * s.light[i].a[k];
          ay += s.light[i].weight[k] * s.light[i].a[k] * s.light[i].y[k];
        }
        at.kd[k] = q.aa[k] > 0 ? std::max(ay / q.aa[k], 0.0f) : 0;
        at.ks[k] = 0;
      }
      if (round == 0) lanes::reweigh(s, at);
    }
  }

  using Colours = std::array<FitTile::Products, 3>;  // of each channel
  void keep(FitTile& tile, const Estimate& at, const Equations& q, const Prior& prior,
            const PriorMaps* maps, int x0, int y) {
    Colours products;
    for (int c = 0; c < tile.channels(); ++c)
      products[static_cast<std::size_t>(c)] = tile.productsOf(c);
    for (int k = 0; k < kLanes && x0 + k < state_.size.width; ++k)
      keepTexel(tile, at, q, products, prior, maps, x0 + k, y, k);
  }

  void keepCurves(FitTile& tile, const Estimate& at, int x0, int y) {
    Samples& s = tile.lanes();
    lanes::countInFull(s);
    Lane spread2;
    for (int k = 0; k < kLanes; ++k)
      spread2[k] = static_cast<float>(lanes::fitOf(s, at, options_.noise.gain, k).spread2(4));
    lanes::CostCurve curve;
    lanes::costCurve(options_.model, s, at, curve);
    for (int k = 0; k < kLanes && x0 + k < state_.size.width; ++k) {
      keepCurve(state_, options_, curve, spread2[k], x0 + k, y, k);
      keepLook(tile, x0 + k, y, k);
    }
  }

  // Levels that count over the diffuse part's irradiance.
  void keepLook(FitTile& tile, int x, int y, int k) {
    const Samples& s = tile.lanes();
    float lit = 0;
    const auto look = state_.look.view().texel(x, y);
    for (std::size_t i = 0; i < s.count; ++i) {
      if (!(s.light[i].weight[k] > 0)) continue;
      lit += s.light[i].a[k];
      for (int c = 0; c < tile.channels(); ++c)
        look[static_cast<std::size_t>(c)] += tile.colour(i, c)[k];
    }
    for (float& v : look) v /= std::max(lit, 1e-6f);
  }

  void keepTexel(FitTile& tile, const Estimate& at, const Equations& q, const Colours& products,
                 const Prior& prior, const PriorMaps* maps, int x, int y, int k) {
    Counts& counts = rows_[static_cast<std::size_t>(y)];
    const Samples& s = tile.lanes();
    int usable = 0;
    float brightest = 0;
    for (std::size_t i = 0; i < s.count; ++i) {
      usable += s.light[i].noise[k] > 0;
      brightest = std::max(brightest, s.light[i].y[k]);
    }
    const lanes::LaneFit fit = lanes::fitOf(s, at, options_.noise.gain, k);
    counts.levels += static_cast<std::int64_t>(s.count);
    counts.used += fit.used;
    counts.square += fit.square;
    state_.residual.at(x, y) = static_cast<float>(std::sqrt(fit.square / std::max(fit.used, 1)));
    state_.told.at(x, y) =
        fit.used >= lanes::kFewestLit && !(options_.deep_shadows && lanes::isSpoilt(s, at, k));
    state_.shadowed.at(x, y) = s.shadowed[k] > 0;
    state_.spread2.at(x, y) = static_cast<float>(fit.spread2(5));
    state_.misfit.at(x, y) = static_cast<float>(fit.misfit(5));
    state_.lamps.at(x, y) = static_cast<float>(fit.lamps);
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
    const bool enough = fit.used >= 6 && usable >= kFewest && glossy();
    const lanes::Certainty certainty =
        enough ? lanes::certaintyOf(at, q, prior, fit.spread2(5), k) : lanes::Certainty{};
    state_.confidence.at(x, y) = static_cast<float>(certainty.confidence);
    state_.specular_weight.at(x, y) = static_cast<float>(certainty.specular_weight);
    keepColours(tile, at, q, products, prior, maps, x, y, k);
  }

  void keepColours(FitTile& tile, const Estimate& at, const Equations& q, const Colours& products,
                   const Prior& prior, const PriorMaps* maps, int x, int y, int k) {
    const Samples& s = tile.lanes();
    const float known = maps ? maps->specular_weight.at(x, y) : 0;
    const float grey = known > 0 ? meanOf(maps->specular.view().texel(x, y)) : 0;
    const float chroma =
        s.shadowed[k] > 0 ? state_.spread2.at(x, y) * kShadowedChromaWeight : kChromaWeight;
    for (int c = 0; c < tile.channels(); ++c) {
      const float tint = known > 0 ? maps->specular.at(x, y, c) - grey : 0;
      const FitTile::Products& sums = products[static_cast<std::size_t>(c)];
      const float ay = sums.diffuse[k], by = sums.gloss[k];
      float kd = 0, ks = 0;
      const float det = q.aa[k] * (q.bb[k] - prior.ks_weight[k]) - q.ab[k] * q.ab[k];
      state_.own_specular.at(x, y, c) = det > 0 ? (q.aa[k] * by - q.ab[k] * ay) / det : 0;
      if (glossy())
        lanes::solveLinear(q.aa[k], q.ab[k], q.bb[k] + chroma, ay,
                           by + prior.ks_weight[k] * prior.ks[k] + known * tint + chroma * at.ks[k],
                           kd, ks);
      else
        kd = q.aa[k] > 0 ? std::max(ay / q.aa[k], 0.0f) : 0;
      // Of few levels almost anything comes out; strengths of Torrance and Sparrow's lobe may be
      // above 1.
      const bool few = s.shadowed[k] > 0 || !state_.told.at(x, y),
                 reflectance = options_.model != Model::kTorranceSparrow;
      state_.diffuse.at(x, y, c) = few ? std::min(kd, 1.0f) : kd;
      state_.specular.at(x, y, c) = few || reflectance ? std::min(ks, 1.0f) : ks;
    }
  }

  const std::vector<FitSample>& samples_;
  const MultiLightOptions& options_;
  bool together_;
  FitState state_;
  std::optional<ShadowMap> shadows_;  // with `deep_shadows`
  std::vector<Counts> rows_;
};

void holdToOthers(Fitter& fitter, const std::vector<FitBefore>& before,
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
  if (options.model == Model::kWardAnisotropic)
    first.model = Model::kWard, first.deep_shadows = false;
  if (options.model == Model::kTorranceSparrow) first.specular_spread = 1;
  const bool together = options.model != Model::kLambert && (options.neighbours || !before.empty());
  Fitter fitter(samples, first, together);
  fitter.firstPass(progress);
  if (first.deep_shadows && options.model != Model::kLambert) fitter.besideShadows(progress);
  FitState& state = fitter.state();
  if (together && options.filters)
    state.look = demosaicLinear(std::as_const(state.look).view(), *options.filters);
  if (together) holdToOthers(fitter, before, first, progress);
  MultiLightFit fit;
  fit.report = fitter.report();
  fit.maps.diffuse = std::move(state.diffuse);
  fit.maps.normal = std::move(state.normal);
  fit.told = std::move(state.told);
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
