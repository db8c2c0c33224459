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

class BananaSurface final : public PreparedSurface {
 public:
  BananaSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override;

 private:
  int width_;
  Fields f_;
};

void BananaSurface::rowAt(double time, int y, SurfaceRow& row) const {
  const auto t = static_cast<float>(time);
  const ColorRamp<7> skin = skinRamp();
  const ColorRamp<4> spot = freckleRamp();
  const Rgb halo_tint{0.80f, 0.62f, 0.42f}, bruise_tint{0.50f, 0.36f, 0.26f};
  const float jitter_now = 4 * t * (1 - t), old = t * t;
  const float fibre_now = 0.05f + 0.14f * t, mottle_now = 0.035f + 0.10f * t;
  const std::size_t at = static_cast<std::size_t>(y) * width_;
  for (int i = 0; i < width_; ++i) {
    const std::size_t k = at + i;
    const float age = t + f_.jitter[k] * jitter_now;
    Rgb c = skin.at(age);
    c = scaled(c, 1 + f_.fibre[k] * fibre_now + f_.mottle[k] * mottle_now);

    const float bruise_raw = saturate((t - f_.bruise[k]) * f_.bruise_inverse_width[k]);
    const float bruise = 0.6f * smooth01(bruise_raw);
    c = {c.r * mix(1, bruise_tint.r, bruise), c.g * mix(1, bruise_tint.g, bruise),
         c.b * mix(1, bruise_tint.b, bruise)};

    const float since = t - f_.freckle[k], inverse_width = f_.freckle_inverse_width[k];
    const float halo =
        0.55f * smooth01(saturate((since + kHalo) * inverse_width * 0.4f)) * saturate(t * 8);
    c = {c.r * mix(1, halo_tint.r, halo), c.g * mix(1, halo_tint.g, halo),
         c.b * mix(1, halo_tint.b, halo)};
    const float s = saturate(since * inverse_width), dark = smooth01(s);
    const Rgb left = scaled(spot.at(since + 0.04f * f_.mottle[k]), 1 + 0.35f * f_.mottle[k]);
    c = {c.r * mix(1, left.r, dark) + 0.012f * dark, c.g * mix(1, left.g, dark) + 0.009f * dark,
         c.b * mix(1, left.b, dark) + 0.007f * dark};

    row[SurfaceRow::kDiffuseR][i] = saturate(c.r);
    row[SurfaceRow::kDiffuseG][i] = saturate(c.g);
    row[SurfaceRow::kDiffuseB][i] = saturate(c.b);
    const float f0 = mix(0.042f, 0.030f, dark);
    row[SurfaceRow::kSpecularR][i] = f0;
    row[SurfaceRow::kSpecularG][i] = f0;
    row[SurfaceRow::kSpecularB][i] = f0;
    const float rough = mix(mix(0.30f, 0.52f, t), 0.68f, 0.8f * dark);
    row[SurfaceRow::kRoughness][i] = saturate(rough + 0.05f * f_.mottle[k]);

    const float sink = 6 * s * (1 - s) * inverse_width * kSinkMm;  // -d height / d arrival
    const float dx = f_.relief_dx[k] + old * f_.wrinkle_dx[k] + sink * f_.freckle_dx[k];
    const float dy = f_.relief_dy[k] + old * f_.wrinkle_dy[k] + sink * f_.freckle_dy[k];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    row[SurfaceRow::kNormalX][i] = -dx * inverse;
    row[SurfaceRow::kNormalY][i] = -dy * inverse;
    row[SurfaceRow::kNormalZ][i] = inverse;
    row[SurfaceRow::kHeight][i] = f_.relief[k] + old * f_.wrinkle[k] - kSinkMm * dark;
    row[SurfaceRow::kDegree][i] =
        saturate(1 - (1 - smooth01(saturate(age))) * (1 - 0.75f * dark) * (1 - 0.4f * bruise));
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
