// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of banana skin over seven days. Lengths in mm, times in shares of the process.
//
//   ripening   each texel has an age a = t + 4 j t (1 - t), j stationary noise, and a base colour
//              ramp(a): green-yellow, yellow, deep yellow, brown. Fibres along y and a fine mottle
//              modulate it, more as it ages.
//   freckles   the union of four classes of spots (blobs.h), from dots to blotches and short
//              streaks; darkness s((t - A) / w) with w so wide that a rim is softer than 0.2 mm
//              and than a texel. Older skin inside a spot is darker; a halo runs ahead of the rim.
//   bruises    few, wide and translucent spots of the same kind.
//   surface    waxy and smooth when fresh, matt when old and inside freckles, which sink; fibres
//              and pores in relief, wrinkles that rise at the end.
//
// Stationary: no gradient larger than a bruise, so that quilting finds blocks that fit.
#include <cmath>

#include "devices/twin/blobs.h"
#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kRimMm = 0.20f;     // softness of a freckle's rim
constexpr float kRimTime = 0.045f;  // a new spot takes this long to show
constexpr float kHalo = 0.07f;      // its halo is so much ahead
constexpr float kBruiseRimMm = 2.2f;
constexpr float kSinkMm = 0.05f;  // of a freckle
constexpr float kWrinkleMm = 0.10f;

struct Fields {
  std::vector<float> jitter, fibre, mottle;
  std::vector<float> freckle, freckle_inverse_width, freckle_dx, freckle_dy;
  std::vector<float> bruise, bruise_inverse_width;
  std::vector<float> relief, relief_dx, relief_dy, wrinkle, wrinkle_dx, wrinkle_dy;
  explicit Fields(std::size_t n) {
    for (auto* f : {&jitter, &fibre, &mottle, &freckle, &freckle_inverse_width, &freckle_dx,
                    &freckle_dy, &bruise, &bruise_inverse_width, &relief, &relief_dx, &relief_dy,
                    &wrinkle, &wrinkle_dx, &wrinkle_dy})
      f->resize(n);
  }
};

const ColorRamp<7>& skinRamp() {
  static const ColorRamp<7> ramp({{{0.00f, fromSrgb(186, 190, 72)},
                                   {0.10f, fromSrgb(210, 203, 72)},
                                   {0.24f, fromSrgb(240, 208, 78)},
                                   {0.50f, fromSrgb(233, 189, 68)},
                                   {0.72f, fromSrgb(208, 155, 62)},
                                   {0.88f, fromSrgb(160, 108, 50)},
                                   {1.00f, fromSrgb(116, 76, 40)}}});
  return ramp;
}

// By the time since a texel was reached: what is left of the skin's colour, down to near black.
const ColorRamp<4>& freckleRamp() {
  static const ColorRamp<4> ramp({{{0.00f, {0.52f, 0.40f, 0.30f}},
                                   {0.06f, {0.30f, 0.19f, 0.16f}},
                                   {0.18f, {0.150f, 0.085f, 0.085f}},
                                   {0.60f, {0.080f, 0.050f, 0.060f}}}});
  return ramp;
}

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float age[kChunk];     // of the skin
  float bruise[kChunk];  // strength
  float since[kChunk];   // a freckle came
  float raw[kChunk];     // its progress in [0,1]; smoothed: its darkness
  float dark[kChunk];
};

class BananaSurface final : public PreparedSurface {
 public:
  BananaSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    Stage stage;
    for (int x = 0; x < width_; x += kChunk) {
      const int count = std::min(kChunk, width_ - x);
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      const auto t = static_cast<float>(time);
      advance(t, at, count, stage);
      paint(t, at, count, stage, x, row);
      shape(t, at, count, stage, x, row);
    }
  }

 private:
  void advance(float t, std::size_t at, int count, Stage& stage) const;
  void paint(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void shape(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  int width_;
  Fields f_;
};

void BananaSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *jitter = &f_.jitter[at], *freckle = &f_.freckle[at],
              *freckle_inverse_width = &f_.freckle_inverse_width[at], *bruise = &f_.bruise[at],
              *bruise_inverse_width = &f_.bruise_inverse_width[at];
  const float jitter_now = 4 * t * (1 - t);
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.age[i] = t + jitter[i] * jitter_now;
    stage.bruise[i] = 0.6f * smooth01(saturate((t - bruise[i]) * bruise_inverse_width[i]));
    stage.since[i] = t - freckle[i];
    stage.raw[i] = saturate(stage.since[i] * freckle_inverse_width[i]);
    stage.dark[i] = smooth01(stage.raw[i]);
  }
}

void BananaSurface::paint(float t, std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const ColorRamp<7> skin = skinRamp();
  const ColorRamp<4> spot = freckleRamp();
  const Rgb halo_tint{0.80f, 0.62f, 0.42f}, bruise_tint{0.50f, 0.36f, 0.26f};
  const float fibre_now = 0.05f + 0.14f * t, mottle_now = 0.035f + 0.10f * t;
  const float halo_now = 0.55f * saturate(t * 8), rough_now = mix(0.30f, 0.52f, t);
  const float *fibre = &f_.fibre[at], *mottle = &f_.mottle[at],
              *inverse_width = &f_.freckle_inverse_width[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *f0_r = row[SurfaceRow::kSpecularR] + x,
        *f0_g = row[SurfaceRow::kSpecularG] + x, *f0_b = row[SurfaceRow::kSpecularB] + x,
        *rough = row[SurfaceRow::kRoughness] + x, *degree = row[SurfaceRow::kDegree] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float dark = stage.dark[i], bruise = stage.bruise[i], since = stage.since[i];
    Rgb c = scaled(skin.at(stage.age[i]), 1 + fibre[i] * fibre_now + mottle[i] * mottle_now);
    c = tinted(c, bruise_tint, bruise);
    c = tinted(c, halo_tint,
               halo_now * smooth01(saturate((since + kHalo) * inverse_width[i] * 0.4f)));
    c = tinted(c, scaled(spot.at(since + 0.04f * mottle[i]), 1 + 0.35f * mottle[i]), dark);
    r[i] = saturate(c.r + 0.012f * dark);
    g[i] = saturate(c.g + 0.009f * dark);
    b[i] = saturate(c.b + 0.007f * dark);
    f0_r[i] = f0_g[i] = f0_b[i] = mix(0.042f, 0.030f, dark);
    rough[i] = saturate(mix(rough_now, 0.68f, 0.8f * dark) + 0.05f * mottle[i]);
    degree[i] = saturate(1 - (1 - smooth01(saturate(stage.age[i]))) * (1 - 0.75f * dark) *
                                 (1 - 0.4f * bruise));
  }
}

void BananaSurface::shape(float t, std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const float *inverse_width = &f_.freckle_inverse_width[at], *freckle_dx = &f_.freckle_dx[at],
              *freckle_dy = &f_.freckle_dy[at], *relief = &f_.relief[at],
              *relief_dx = &f_.relief_dx[at], *relief_dy = &f_.relief_dy[at],
              *wrinkle = &f_.wrinkle[at], *wrinkle_dx = &f_.wrinkle_dx[at],
              *wrinkle_dy = &f_.wrinkle_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  const float old = t * t;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float s = stage.raw[i];
    const float sink = 6 * s * (1 - s) * inverse_width[i] * kSinkMm;  // -d height / d arrival
    const float dx = relief_dx[i] + old * wrinkle_dx[i] + sink * freckle_dx[i];
    const float dy = relief_dy[i] + old * wrinkle_dy[i] + sink * freckle_dy[i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = relief[i] + old * wrinkle[i] - kSinkMm * stage.dark[i];
  }
}

struct Freckles {
  BlobField field;
  float warp;  // how ragged
};

class Banana final : public Specimen {
 public:
  explicit Banana(std::uint64_t seed) : seed_(seed) {}
  const SpecimenInfo& info() const override { return bananaInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0xba7a7aull, field); }
  std::vector<Freckles> freckles(const Bounds& b) const;
  void fillRow(const SampleGrid& grid, int y, const std::vector<Freckles>& freckle,
               const BlobField& bruise, Fields& f) const;

  std::uint64_t seed_;
  mutable RegularSurface regular_;
};

std::vector<Freckles> Banana::freckles(const Bounds& b) const {
  // seed, cell; chance; radius from, to, power; onset from, to, power; growth, power, elongation
  const BlobOptions classes[] = {
      // pin-point dots, many and early
      {key(1), 1.2f, 0.55f, 0.15f, 0.5f, 1.8f, 0.14f, 1.10f, 0.9f, 0.8f, 2.0f, 1.3f},
      // ordinary freckles
      {key(2), 2.8f, 0.85f, 0.60f, 2.0f, 1.8f, 0.18f, 0.98f, 0.95f, 0.85f, 1.7f, 1.4f},
      // blotches
      {key(3), 7.2f, 0.85f, 2.00f, 4.8f, 1.2f, 0.24f, 0.92f, 1.0f, 0.85f, 1.5f, 1.45f},
      // short streaks along the fibres
      {key(4), 6.0f, 0.50f, 0.20f, 0.6f, 1.5f, 0.30f, 1.00f, 0.9f, 0.8f, 1.7f, 9.0f},
  };
  const float warps[] = {0.3f, 0.8f, 1.2f, 0.6f};
  std::vector<Freckles> kinds;
  for (int i = 0; i < 4; ++i)
    kinds.push_back({BlobField(classes[i], b.x0, b.y0, b.x1, b.y1), warps[i]});
  return kinds;
}

void Banana::fillRow(const SampleGrid& grid, int y, const std::vector<Freckles>& freckle,
                     const BlobField& bruise, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise jitter{key(10), 14, 3}, warp_x{key(11), 2.4f, 4, 0.5f},
      warp_y{key(12), 2.4f, 4, 0.5f}, wide_x{key(13), 14, 3}, wide_y{key(14), 14, 3},
      fibre{key(15), 2.4f, 5, 0.62f, 1, 22}, mottle{key(16), 3.0f, 5, 0.6f},
      pores{key(17), 0.7f, 2}, wrinkle{key(18), 2.6f, 3, 0.45f, 1, 6};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const float fibres = fibre.at(px, py, texel);
    f.fibre[k] = fibres;
    f.mottle[k] = mottle.at(px, py, texel);
    f.jitter[k] = std::clamp(0.16f * jitter.at(px, py, kAsIs) + 0.04f * fibres, -0.2f, 0.2f);
    f.relief[k] = 0.020f * fibres + 0.010f * pores.at(px, py, texel);
    f.wrinkle[k] = kWrinkleMm * wrinkle.at(px, py, texel);

    const float wx = 0.55f * warp_x.at(px, py, kAsIs);
    const float wy = 0.75f * warp_y.at(px, py, kAsIs);
    const Rim rim{kRimTime, kRimMm, 0.4f, texel};
    Arrival first;
    for (const Freckles& kind : freckle)
      first = kind.field.at(px + kind.warp * wx, py + kind.warp * wy, rim, first);
    f.freckle[k] = first.time;
    f.freckle_inverse_width[k] = 1 / first.width;

    const Arrival area =
        bruise.at(px + 3.0f * wide_x.at(px, py, kAsIs), py + 3.0f * wide_y.at(px, py, kAsIs),
                  {0.12f, kBruiseRimMm, 0.6f}, Arrival{});
    f.bruise[k] = area.time + 0.05f * f.mottle[k];
    f.bruise_inverse_width[k] = 1 / area.width;
  }
}

std::shared_ptr<const PreparedSurface> Banana::prepare(const SampleGrid& grid) const {
  const Bounds b = boundsOf(grid, 12);
  const std::vector<Freckles> freckle = freckles(b);
  const BlobField bruise({key(5), 19, 0.7f, 7, 15, 1, 0.40f, 0.95f, 1, 1.1f, 1.3f, 1.25f}, b.x0,
                         b.y0, b.x1, b.y1);
  Fields f(grid.x_mm.size());
  forRowBlocks({grid.size.width, grid.size.height}, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) fillRow(grid, y, freckle, bruise, f);
  });
  differentiate(grid, f.freckle, f.freckle_dx, f.freckle_dy, 1.0f);
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 2.0f);
  differentiate(grid, f.wrinkle, f.wrinkle_dx, f.wrinkle_dy, 2.0f);
  return std::make_shared<BananaSurface>(grid.size.width, std::move(f));
}

}  // namespace

const SpecimenInfo& bananaInfo() {
  static const SpecimenInfo info{"banana_ripening", "banana skin: yellow, freckled, brown",
                                 std::chrono::hours(7 * 24), 60};
  return info;
}

std::unique_ptr<Specimen> makeBanana(std::uint64_t seed) { return std::make_unique<Banana>(seed); }

}  // namespace patina::devices::twin
