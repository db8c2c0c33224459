// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of a planed, soaked plank that dries over five hours. The grain runs along x.
// Lengths in mm, times in shares of the process.
//
//   wood      a plane cut through growth rings about a pith below it: arches and lines, r^2 =
//             (y - y_p)^2 + z^2, each ring pale at first and dark at its end, widths different from
//             year to year (the solid texture of Peachey, "Solid texturing of complex surfaces",
//             1985). Round a knot the grain flows as an ideal fluid round a cylinder, psi =
//             (y - y_k)(1 - R^2 / d^2), which is how grain is predicted there (Foley, "Modeling the
//             effects of knots in structural timber", 2003). Fibres and pores along the grain.
//   front     water leaves wood along its fibres many times faster than across (Siau, "Transport
//             processes in wood", 1984), so a wet front withdraws from both ends in fingers along
//             the grain, earlier in the porous wood of spring than in that of autumn. First the
//             film of water over the surface breaks up, then the wood below it pales.
//   colour    wet wood is darker and more saturated: light that enters is scattered forward and
//             kept in by the film (Lekner and Dorf, "Why some things are darker when wet", 1988).
//   surface   the film hides the relief; dry, the fibres rise, autumn wood stands above spring
//   wood,
//             and the plank cups, as rings shrink more along than across.
//
// Gloss is measured: ABC fits (processing/brdf/abc.h) of MERL's fruitwood-241, the narrowest lobe
// of its woods, for the wet surface, and special-walnut-224, the broadest and faintest, for the
// dry.
#include <cmath>

#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

const MeasuredReflectance& woodGloss() {
  static const MeasuredReflectance gloss{
      {{5.976665f, 5.760932f, 5.568172f}, 192.199890f, 1.573300f, 1.483582f},
      {{0.704096f, 0.693490f, 0.676845f}, 15.779606f, 2.668091f, 1.883156f}};
  return gloss;
}

constexpr float kWidthMm = 80;
constexpr float kEndMm = 46;  // of the plank, to both sides
constexpr float kFilmTime = 0.020f, kFilmRimMm = 0.15f;
constexpr float kFrontTime = 0.050f;  // the front passes a fibre
constexpr float kFrontMm = 0.3f;      // how wide it is
constexpr float kRingMm = 3.4f;
constexpr float kBarkMm = 0.6f;
constexpr float kFilmMm = 0.05f;
constexpr float kCupMm = 0.9f;  // at the edges of the picture, in the end

struct Fields {
  std::vector<float> ring, fibre, knot, mottle;
  std::vector<float> film, film_inverse_width, film_dx, film_dy;
  std::vector<float> front, front_inverse_width, front_dx, front_dy;
  std::vector<float> relief, relief_dx, relief_dy, ridge, ridge_dx, ridge_dy;
  std::vector<float> y_mm;
  explicit Fields(std::size_t n) {
    for (auto* f : {&ring, &fibre, &knot, &mottle, &film, &film_inverse_width, &film_dx, &film_dy,
                    &front, &front_inverse_width, &front_dx, &front_dy, &relief, &relief_dx,
                    &relief_dy, &ridge, &ridge_dx, &ridge_dy})
      f->resize(n);
  }
};

// A ring is pale at first, then ever darker, the cube of its part; at its end at once pale again.
// The mean over `width` years, so that it is the same at any size.
float ringShade(float year, float width) {
  const auto sum = [](float years) {  // from year 0
    const float whole = std::floor(years), part = years - whole;
    return 0.25f * (whole + part * part * part * part);
  };
  return (sum(year + 0.5f * width) - sum(year - 0.5f * width)) / width;
}

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float bare_raw[kChunk], bare[kChunk];  // of the film of water
  float dry_raw[kChunk], dry[kChunk];
  float degree[kChunk];
};

class WoodSurface final : public PreparedSurface {
 public:
  WoodSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    Stage stage;
    const auto t = static_cast<float>(time);
    for (int x = 0; x < width_; x += kChunk) {
      const int count = std::min(kChunk, width_ - x);
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      advance(t, at, count, stage);
      paint(at, count, stage, x, row);
      finish(count, stage, x, row);
      shape(t, at, count, stage, x, row);
    }
  }

 private:
  void advance(float t, std::size_t at, int count, Stage& stage) const;
  void paint(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void finish(int count, const Stage& stage, int x, SurfaceRow& row) const;
  void shape(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  int width_;
  Fields f_;
};

void WoodSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *film = &f_.film[at], *film_inverse_width = &f_.film_inverse_width[at],
              *front = &f_.front[at], *front_inverse_width = &f_.front_inverse_width[at];
  const float seasoned = t * t;  // bound water, everywhere
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.bare_raw[i] = saturate((t - film[i]) * film_inverse_width[i]);
    stage.bare[i] = smooth01(stage.bare_raw[i]);
    stage.dry_raw[i] = saturate((t - front[i]) * front_inverse_width[i]);
    const float passed = smooth01(stage.dry_raw[i]);
    stage.dry[i] = passed * (0.86f + 0.14f * seasoned);
    stage.degree[i] = 0.45f * stage.bare[i] + 0.45f * passed + 0.10f * seasoned;
  }
}

// Diffuse colour and degree.
void WoodSurface::paint(std::size_t at, int count, const Stage& stage, int x,
                        SurfaceRow& row) const {
  const Rgb dry_spring{0.650f, 0.465f, 0.275f}, dry_autumn{0.430f, 0.245f, 0.115f};
  const Rgb wet_spring{0.290f, 0.142f, 0.052f}, wet_autumn{0.140f, 0.055f, 0.020f};
  const Rgb dry_knot{0.110f, 0.042f, 0.016f}, wet_knot{0.050f, 0.018f, 0.008f};
  const float *ring = &f_.ring[at], *fibre = &f_.fibre[at], *knot = &f_.knot[at],
              *mottle = &f_.mottle[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *degree = row[SurfaceRow::kDegree] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const Rgb dry = mix(mix(dry_spring, dry_autumn, ring[i]), dry_knot, knot[i]);
    const Rgb wet = mix(mix(wet_spring, wet_autumn, ring[i]), wet_knot, knot[i]);
    const float fine = 1 + (0.20f - 0.04f * stage.dry[i]) * fibre[i] + 0.10f * mottle[i];
    const Rgb d = scaled(mix(wet, dry, stage.dry[i]), fine);
    r[i] = std::min(std::max(d.r, 0.0f), 0.9f);
    g[i] = std::min(std::max(d.g, 0.0f), 0.9f);
    b[i] = std::min(std::max(d.b, 0.0f), 0.9f);
    degree[i] = stage.degree[i];
  }
}

// What stands for the measured gloss where only GGX is spoken.
void WoodSurface::finish(int count, const Stage& stage, int x, SurfaceRow& row) const {
  static const brdf::GgxEquivalent fresh = brdf::nearestGgx(woodGloss().fresh),
                                   aged = brdf::nearestGgx(woodGloss().aged);
  const brdf::GgxEquivalent from = fresh, to = aged;
  float *r = row[SurfaceRow::kSpecularR] + x, *g = row[SurfaceRow::kSpecularG] + x,
        *b = row[SurfaceRow::kSpecularB] + x, *roughness = row[SurfaceRow::kRoughness] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    r[i] = mix(from.f0[0], to.f0[0], stage.degree[i]);
    g[i] = mix(from.f0[1], to.f0[1], stage.degree[i]);
    b[i] = mix(from.f0[2], to.f0[2], stage.degree[i]);
    roughness[i] = mix(from.alpha, to.alpha, stage.degree[i]);
  }
}

void WoodSurface::shape(float t, std::size_t at, int count, const Stage& stage, int x,
                        SurfaceRow& row) const {
  const float *relief = &f_.relief[at], *relief_dx = &f_.relief_dx[at],
              *relief_dy = &f_.relief_dy[at], *ridge = &f_.ridge[at], *ridge_dx = &f_.ridge_dx[at],
              *ridge_dy = &f_.ridge_dy[at], *y_mm = &f_.y_mm[at],
              *film_inverse_width = &f_.film_inverse_width[at], *film_dx = &f_.film_dx[at],
              *film_dy = &f_.film_dy[at], *front_inverse_width = &f_.front_inverse_width[at],
              *front_dx = &f_.front_dx[at], *front_dy = &f_.front_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  const float cup = kCupMm * smooth01(t) / (kWidthMm * kWidthMm / 4);
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float rough = 0.20f + 0.15f * stage.bare[i] + 0.65f * stage.dry[i];
    // - d height / d time at the edges of the film and of the front, against the arrival.
    const float p = stage.bare_raw[i], q = stage.dry_raw[i];
    const float ebb = 6 * p * (1 - p) * film_inverse_width[i] * (kFilmMm - 0.15f * relief[i]);
    const float rise = -6 * q * (1 - q) * front_inverse_width[i] * (0.65f * relief[i] + ridge[i]);
    const float dx =
        rough * relief_dx[i] + stage.dry[i] * ridge_dx[i] + ebb * film_dx[i] + rise * front_dx[i];
    const float dy = rough * relief_dy[i] + stage.dry[i] * ridge_dy[i] + ebb * film_dy[i] +
                     rise * front_dy[i] + 2 * cup * y_mm[i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = rough * relief[i] + stage.dry[i] * ridge[i] + kFilmMm * (1 - stage.bare[i]) +
                cup * y_mm[i] * y_mm[i];
  }
}

struct Knot {
  float x_mm, y_mm, radius_mm;
};

class Wood final : public Specimen {
 public:
  explicit Wood(std::uint64_t seed);
  const SpecimenInfo& info() const override { return woodInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }
  const MeasuredReflectance* measured() const override { return &woodGloss(); }

 private:
  // Where a place lies in the grain.
  struct Grain {
    float across_mm = 0;  // y as if there were no knots
    float knot = 0;       // share of knot wood
    float within_mm = 0;  // to the middle of a knot, when in one
  };
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0x300dull, field); }
  Grain grainAt(float x, float y, float edge_mm) const;
  void fillWood(const SampleGrid& grid, int y, Fields& f) const;
  void fillWater(const SampleGrid& grid, int y, Fields& f) const;

  std::uint64_t seed_;
  float pith_y_mm_, pith_z_mm_, pith_tilt_;
  std::vector<Knot> knots_;
  mutable RegularSurface regular_;
};

Wood::Wood(std::uint64_t seed) : seed_(seed) {
  const auto draw = [&](std::uint64_t n, float from, float to) {
    return from + (to - from) * static_cast<float>(uniform(key(100 + n)));
  };
  pith_y_mm_ = draw(0, -14, 14);
  pith_z_mm_ = draw(1, 10, 20);
  pith_tilt_ = draw(2, 0.10f, 0.22f) * (draw(3, -1, 1) < 0 ? -1.0f : 1.0f);
  const float side = pith_y_mm_ > 0 ? -1.0f : 1.0f;
  knots_.push_back({draw(4, -22, 22), side * draw(5, 6, 22), draw(6, 3.8f, 5.6f)});
  knots_.push_back({draw(7, -36, 36), -side * draw(8, 14, 34), draw(9, 0.9f, 1.6f)});
}

Wood::Grain Wood::grainAt(float x, float y, float edge_mm) const {
  Grain grain{y, 0, 0};
  const FractalNoise bent{key(30), 7, 3, 0.5f};
  for (const Knot& k : knots_) {
    const float dx = 0.62f * (x - k.x_mm), dy = y - k.y_mm;
    const float d2 = std::max(dx * dx + dy * dy, 1e-4f), d = std::sqrt(d2);
    const float r2 = k.radius_mm * k.radius_mm;
    if (d2 > 40 * r2) {
      grain.across_mm -= dy * r2 / d2;
      continue;
    }
    const float ragged = d * (1 + 0.15f * bent.at(x, y, kAsIs));
    grain.across_mm -= dy * std::min(r2 / d2, 1.0f);
    const float inside = smooth01(saturate((k.radius_mm - ragged) / edge_mm + 0.5f));
    if (inside > grain.knot) {
      grain.knot = inside;
      grain.within_mm = ragged;
    }
  }
  return grain;
}

void Wood::fillWood(const SampleGrid& grid, int y, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise wave{key(10), 26, 4, 0.5f, 3.5f, 1}, years{key(11), 5, 2},
      fibre{key(12), 0.9f, 5, 0.72f, 34, 1}, pores{key(13), 0.45f, 3, 0.8f, 14, 1},
      mottle{key(14), 9, 4, 0.5f, 3, 1};
  const float edge = std::hypot(kBarkMm, texel);
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const Grain g = grainAt(px, py, edge);
    const float across = g.across_mm - pith_y_mm_ + 2.6f * wave.at(px, py, kAsIs);
    const float above = pith_z_mm_ + pith_tilt_ * px;
    const float trunk = std::sqrt(across * across + above * above);
    const float radius = g.knot > 0.5f ? 2.3f * g.within_mm : trunk;  // the seam lies under bark
    const float year = radius / kRingMm + 0.45f * years.at(radius, 0.5f, kAsIs);
    const float slope = g.knot > 0.5f ? 2.3f : std::hypot(across, pith_tilt_ * above) / trunk;
    f.ring[k] = ringShade(year, std::max(0.06f, texel * slope / kRingMm));
    f.fibre[k] =
        0.75f * fibre.at(px, g.across_mm, texel) + 0.85f * pores.at(px, g.across_mm, texel);
    f.mottle[k] = mottle.at(px, py, texel);
    const float bark =
        4 * g.knot * (1 - g.knot) * kBarkMm / edge;  // what is left of it round a knot
    f.ring[k] = std::max(f.ring[k], 0.95f * bark);
    f.knot[k] = std::max(g.knot * (0.80f + 0.20f * f.ring[k]), 0.9f * bark);
    f.relief[k] = 0.030f * f.fibre[k];
    f.ridge[k] = 0.045f * f.ring[k] + 0.10f * g.knot;
  }
}

void Wood::fillWater(const SampleGrid& grid, int y, Fields& f) const {
  const FractalNoise fingers{key(20), 4.0f, 6, 0.62f, 22, 1}, areas{key(21), 22, 3, 0.5f, 2, 1},
      film{key(22), 6, 4, 0.55f, 4, 1};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const Grain g = grainAt(px, py, 1.0f);
    const float from_left = saturate((kEndMm + px) / (2 * kEndMm)),
                from_right = saturate((kEndMm - px) / (2 * kEndMm));
    const float left = 0.10f + 1.15f * from_left, right = 0.16f + 1.45f * from_right;
    const float soft = std::max(0.10f - std::abs(left - right), 0.0f);
    const float reach = std::min(left, right) - soft * soft * 2.5f;
    const float held = 0.30f * fingers.at(px, g.across_mm, kAsIs) +
                       0.16f * areas.at(px, py, kAsIs) + 0.07f * (f.ring[k] - 0.3f) -
                       0.10f * g.knot;                    // whose fibres end here
    const float late = smooth01(saturate(reach * 2.2f));  // at the ends all fibres are alike
    f.front[k] = std::clamp(reach + held * (0.35f + 0.65f * late), 0.06f, 0.88f);
    f.film[k] = std::clamp(0.55f * (f.front[k] - 0.04f) + 0.07f * film.at(px, py, kAsIs), 0.02f,
                           f.front[k]);
  }
}

std::shared_ptr<const PreparedSurface> Wood::prepare(const SampleGrid& grid) const {
  Fields f(grid.x_mm.size());
  f.y_mm = grid.y_mm;
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      fillWood(grid, y, f);
      fillWater(grid, y, f);
    }
  });
  soften(grid, {kFilmTime, kFilmRimMm, 0.06f, 0.15f}, f.film, f.film_inverse_width, f.film_dx,
         f.film_dy);
  soften(grid, {kFrontTime, kFrontMm, 0.10f, 0.15f}, f.front, f.front_inverse_width, f.front_dx,
         f.front_dy);
  for (float& film : f.film) film = std::max(film, 0.005f);
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 1.0f);
  differentiate(grid, f.ridge, f.ridge_dx, f.ridge_dy, 1.0f);
  return std::make_shared<WoodSurface>(grid.size.width, std::move(f));
}

}  // namespace

const SpecimenInfo& woodInfo() {
  static const SpecimenInfo info{"wood_drying",
                                 "a soaked plank: dark and glossy, drying along the grain",
                                 std::chrono::hours(5), kWidthMm};
  return info;
}

std::unique_ptr<Specimen> makeWood(std::uint64_t seed) { return std::make_unique<Wood>(seed); }

}  // namespace patina::devices::twin
