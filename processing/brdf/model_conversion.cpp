// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/model_conversion.h"

#include <array>
#include <cmath>
#include <vector>

#include "processing/brdf/ggx.h"
#include "processing/brdf/torrance_sparrow.h"
#include "processing/brdf/ward.h"

namespace patina::brdf {
namespace {

struct Place {
  LobeCosines cosines;
  double weight;  // sqrt of the quadrature's, times n.l
};

// Half vectors in rings that grow with the lobe: tan(h) = r tan-step, so that narrow lobes are seen
// as well as wide ones.
std::vector<Place> placesFor(double roughness) {
  constexpr int kRings = 24, kColumns = 12;
  constexpr std::array<double, 3> kViews{0, 35 * M_PI / 180, 60 * M_PI / 180};
  const double reach = std::min(1.5, 6 * roughness);  // of the half vector's angle, rad
  std::vector<Place> places;
  for (const double view : kViews) {
    const double sin_v = std::sin(view), n_v = std::cos(view);
    for (int i = 0; i < kRings; ++i) {
      const double theta = (i + 0.5) / kRings * reach, n_h = std::cos(theta);
      for (int j = 0; j < kColumns; ++j) {
        const double phi = 2 * M_PI * (j + 0.5) / kColumns;
        const double v_h = sin_v * std::sin(theta) * std::cos(phi) + n_v * n_h;
        const double n_l = 2 * v_h * n_h - n_v;
        if (v_h < 0.05 || n_l < 0.05) continue;
        places.push_back({{static_cast<float>(n_l), static_cast<float>(n_v),
                           static_cast<float>(n_h), static_cast<float>(v_h)},
                          n_l * std::sqrt(4 * v_h * std::sin(theta))});
      }
    }
  }
  return places;
}

// The reflectance is `fixed + specular * slope`.
struct Split {
  double fixed, slope;
};
Split splitAt(Model model, const Place& place, double roughness) {
  const double value = lobeOf(model, place.cosines, static_cast<float>(roughness)).value;
  const double weight = model == Model::kGgx ? double{schlickWeight(place.cosines.v_h)} : 0.0;
  return {place.weight * value * weight, place.weight * value * (1 - weight)};
}

struct Solved {
  double specular, misfit;  // misfit: sum of squares
};
Solved solveAt(Model model, double roughness, const std::vector<Place>& places,
               const std::vector<double>& wanted) {
  double ss = 0, sw = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Split split = splitAt(model, places[i], roughness);
    ss += split.slope * split.slope;
    sw += split.slope * (wanted[i] - split.fixed);
  }
  const double specular = std::max(sw / std::max(ss, 1e-300), 0.0);
  double misfit = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Split split = splitAt(model, places[i], roughness);
    const double off = wanted[i] - split.fixed - specular * split.slope;
    misfit += off * off;
  }
  return {specular, misfit};
}

}  // namespace

Lobe lobeOf(Model model, const LobeCosines& c, float roughness) {
  PATINA_CHECK(model != Model::kLambert);
  if (model == Model::kGgx) return ggxLobe(c, roughness);
  if (model == Model::kTorranceSparrow) return torranceSparrowLobe(c, roughness);
  return wardLobe(c, roughness);
}

Conversion convert(const SpecularPart& part, Model from, Model to) {
  const std::vector<Place> places = placesFor(part.roughness);
  std::vector<double> wanted(places.size());
  double energy = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Split split = splitAt(from, places[i], part.roughness);
    wanted[i] = split.fixed + part.specular * split.slope;
    energy += wanted[i] * wanted[i];
  }
  // Golden section on the logarithm, around the best of a coarse scan.
  const auto misfit = [&](double log_r) {
    return solveAt(to, std::exp(log_r), places, wanted).misfit;
  };
  const double low = std::log(0.01), high = std::log(to == Model::kTorranceSparrow ? 3.0 : 1.0);
  constexpr int kScan = 40;
  double best = low, least = HUGE_VAL;
  for (int i = 0; i <= kScan; ++i) {
    const double at = low + (high - low) * i / kScan, value = misfit(at);
    if (value < least) least = value, best = at;
  }
  double a = std::max(low, best - (high - low) / kScan),
         b = std::min(high, best + (high - low) / kScan);
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 30; ++i) {
    const double p = b - kGolden * (b - a), q = a + kGolden * (b - a);
    (misfit(p) < misfit(q) ? b : a) = misfit(p) < misfit(q) ? q : p;
  }
  const double roughness = std::exp((a + b) / 2);
  const Solved solved = solveAt(to, roughness, places, wanted);
  return {{solved.specular, roughness}, energy > 0 ? std::sqrt(solved.misfit / energy) : 0};
}

double alphaFrom(double roughness, RoughnessKind kind) {
  PATINA_CHECK(kind != RoughnessKind::kSigma);
  return kind == RoughnessKind::kPerceptual ? roughness * roughness : roughness;
}

double roughnessFrom(double alpha, RoughnessKind kind) {
  PATINA_CHECK(kind != RoughnessKind::kSigma);
  return kind == RoughnessKind::kPerceptual ? std::sqrt(alpha) : alpha;
}

}  // namespace patina::brdf
