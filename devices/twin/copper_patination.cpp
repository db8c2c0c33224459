// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of copper under a patinating liquid over six hours. Lengths in mm, times in
// shares of the process.
//
//   metal     bright, brushed along x: anisotropic relief, reflectance and roughness.
//   liquid    spreads over the sheet in the first minutes, then dries from patches whose fronts
//             meet: darker, smooth and shiny while wet; tide marks where the front stood.
//   tarnish   brown, first near what will turn green, in the end everywhere.
//   patina    spreads from three classes of seeds (blobs.h) at positions warped over four octaves
//             and along crests of ridged noise, so that rims are ragged; dark teal when thin,
//             verdigris when thick; a matt granular crust.
//
// Colours: reflectance of copper at normal incidence, (0.955, 0.638, 0.538) by its measured index,
// squared for what bounces twice in the
// brush marks; basic copper salts around (0.2, 0.45,
// 0.4) in linear light.
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

constexpr float kWettingWidth = 0.006f;
constexpr float kDryingTime = 0.010f;
constexpr float kDryingMm = 0.9f;  // how wide the edge of the liquid is
constexpr float kTarnishTime = 0.30f;
constexpr float kRimMm = 0.15f;
constexpr float kRimTime = 0.025f;
constexpr float kFilmMm = 0.12f;
constexpr float kPoolMm = 0.34f;  // swell of the film over the sheet
constexpr float kCrustMm = 0.07f;

struct Fields {
  std::vector<float> brush, mottle, grain;
  std::vector<float> wetting, drying, drying_inverse_width, drying_dx, drying_dy, tide;
  std::vector<float> tarnish;
  std::vector<float> patina, patina_inverse_width, patina_dx, patina_dy;
  std::vector<float> relief, relief_dx, relief_dy, crust, crust_dx, crust_dy, pool, pool_dx,
      pool_dy;
  explicit Fields(std::size_t n) {
    for (auto* f : {&brush,     &mottle,    &grain,  &wetting,   &drying,    &drying_inverse_width,
                    &drying_dx, &drying_dy, &tide,   &tarnish,   &patina,    &patina_inverse_width,
                    &patina_dx, &patina_dy, &relief, &relief_dx, &relief_dy, &crust,
                    &crust_dx,  &crust_dy,  &pool,   &pool_dx,   &pool_dy})
      f->resize(n);
  }
};

// By the time since the patina arrived.
const ColorRamp<5>& patinaRamp() {
  static const ColorRamp<5> ramp({{{0.00f, {0.060f, 0.075f, 0.045f}},
                                   {0.06f, {0.055f, 0.150f, 0.120f}},
                                   {0.18f, {0.110f, 0.300f, 0.255f}},
                                   {0.40f, {0.190f, 0.445f, 0.385f}},
                                   {0.75f, {0.290f, 0.560f, 0.490f}}}});
  return ramp;
}

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float arrived[kChunk];  // of the liquid
  float dried_raw[kChunk], dried[kChunk];
  float wet[kChunk];
  float brown[kChunk];
  float since[kChunk];  // the patina came
  float green_raw[kChunk], green[kChunk];
};

class CopperSurface final : public PreparedSurface {
 public:
  CopperSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    Stage stage;
    for (int x = 0; x < width_; x += kChunk) {
      const int count = std::min(kChunk, width_ - x);
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      advance(static_cast<float>(time), at, count, stage);
      paint(at, count, stage, x, row);
      finish(at, count, stage, x, row);
      shape(at, count, stage, x, row);
    }
  }

 private:
  void advance(float t, std::size_t at, int count, Stage& stage) const;
  void paint(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void finish(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void shape(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  int width_;
  Fields f_;
};

void CopperSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *wetting = &f_.wetting[at], *drying = &f_.drying[at],
              *drying_inverse_width = &f_.drying_inverse_width[at], *tarnish = &f_.tarnish[at],
              *patina = &f_.patina[at], *patina_inverse_width = &f_.patina_inverse_width[at];
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.arrived[i] = smooth01(saturate((t - wetting[i]) / kWettingWidth));
    stage.dried_raw[i] = saturate((t - drying[i]) * drying_inverse_width[i]);
    stage.dried[i] = smooth01(stage.dried_raw[i]);
    stage.wet[i] = stage.arrived[i] * (1 - stage.dried[i]);
    stage.brown[i] = smooth01(saturate((t - tarnish[i]) / kTarnishTime));
    stage.since[i] = t - patina[i];
    stage.green_raw[i] = saturate(stage.since[i] * patina_inverse_width[i]);
    stage.green[i] = smooth01(stage.green_raw[i]);
  }
}

// Diffuse colour and degree.
void CopperSurface::paint(std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const ColorRamp<5> verdigris = patinaRamp();
  const Rgb metal{0.030f, 0.014f, 0.009f}, tarnish{0.085f, 0.038f, 0.022f};
  const Rgb chalk_white{0.16f, 0.26f, 0.22f}, film{0.010f, 0.036f, 0.032f};
  const float *mottle = &f_.mottle[at], *grain = &f_.grain[at], *tide = &f_.tide[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *degree = row[SurfaceRow::kDegree] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float brown = stage.brown[i], green = stage.green[i], wet = stage.wet[i];
    Rgb d = mix(metal, scaled(tarnish, 1 + 0.35f * mottle[i]), brown);
    d = mix(d, chalk_white, 0.28f * tide[i] * stage.dried[i] * brown);  // where its edge stood
    const Rgb salt = verdigris.at(stage.since[i] + 0.10f * mottle[i]);
    d = mix(d, scaled(salt, 1 + 0.22f * mottle[i] + 0.16f * grain[i]), green);
    const float shade = mix(1, 0.48f, wet);
    r[i] = saturate(d.r * shade + film.r * wet);
    g[i] = saturate(d.g * shade + film.g * wet);
    b[i] = saturate(d.b * shade + film.b * wet);
    degree[i] = 1 - (1 - 0.55f * brown) * (1 - green * smooth01(saturate(stage.since[i] * 3.3f)));
  }
}

// Specular colour and roughness.
void CopperSurface::finish(std::size_t at, int count, const Stage& stage, int x,
                           SurfaceRow& row) const {
  const Rgb metal{0.93f, 0.45f, 0.28f}, tarnish{0.17f, 0.070f, 0.040f};
  const Rgb salt{0.035f, 0.035f, 0.035f}, film_tint{0.74f, 0.98f, 0.95f};
  const float *brush = &f_.brush[at], *d_r = row[SurfaceRow::kDiffuseR] + x,
              *d_g = row[SurfaceRow::kDiffuseG] + x, *d_b = row[SurfaceRow::kDiffuseB] + x;
  float *r = row[SurfaceRow::kSpecularR] + x, *g = row[SurfaceRow::kSpecularG] + x,
        *b = row[SurfaceRow::kSpecularB] + x, *roughness = row[SurfaceRow::kRoughness] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float brown = stage.brown[i], green = stage.green[i], wet = stage.wet[i];
    Rgb f0 = scaled(mix(metal, tarnish, brown), 1 + 0.16f * brush[i] * (1 - 0.5f * brown));
    f0 = tinted(mix(f0, salt, green), film_tint, wet);
    r[i] = std::min(saturate(f0.r + 0.02f * wet), 0.97f - d_r[i]);
    g[i] = std::min(saturate(f0.g + 0.02f * wet), 0.97f - d_g[i]);
    b[i] = std::min(saturate(f0.b + 0.02f * wet), 0.97f - d_b[i]);
    const float rough = mix(mix(0.44f + 0.05f * brush[i], 0.56f, brown), 0.85f, green);
    roughness[i] = std::max(saturate(mix(rough, 0.13f, 0.95f * wet)), 0.02f);
  }
}

// Normal and height: the brush marks drown in the film and vanish under the crust.
void CopperSurface::shape(std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const float *relief = &f_.relief[at], *relief_dx = &f_.relief_dx[at],
              *relief_dy = &f_.relief_dy[at], *crust = &f_.crust[at], *crust_dx = &f_.crust_dx[at],
              *crust_dy = &f_.crust_dy[at], *pool = &f_.pool[at], *pool_dx = &f_.pool_dx[at],
              *pool_dy = &f_.pool_dy[at], *drying_inverse_width = &f_.drying_inverse_width[at],
              *drying_dx = &f_.drying_dx[at], *drying_dy = &f_.drying_dy[at],
              *patina_inverse_width = &f_.patina_inverse_width[at], *patina_dx = &f_.patina_dx[at],
              *patina_dy = &f_.patina_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float green = stage.green[i], wet = stage.wet[i];
    const float bare = (1 - 0.9f * wet) * (1 - 0.8f * green), crusted = green * (1 - wet);
    // d height / d arrival of the liquid's edge and of the patina's.
    const float q = stage.dried_raw[i], s = stage.green_raw[i];
    const float edge = 6 * q * (1 - q) * drying_inverse_width[i] * kFilmMm * stage.arrived[i];
    const float grow = 6 * s * (1 - s) * patina_inverse_width[i] * kCrustMm * (1 - wet);
    const float dx = bare * relief_dx[i] + wet * pool_dx[i] + crusted * crust_dx[i] +
                     edge * drying_dx[i] - grow * patina_dx[i];
    const float dy = bare * relief_dy[i] + wet * pool_dy[i] + crusted * crust_dy[i] +
                     edge * drying_dy[i] - grow * patina_dy[i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = bare * relief[i] + (kFilmMm + pool[i]) * wet + green * (kCrustMm + crust[i]);
  }
}

class Copper final : public Specimen {
 public:
  explicit Copper(std::uint64_t seed) : seed_(seed) {}
  const SpecimenInfo& info() const override { return copperInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0xc0bbe2ull, field); }
  std::vector<BlobField> seeds(const Bounds& b) const;
  void fillLiquid(const SampleGrid& grid, int y, const BlobField& patches, Fields& f) const;
  void fillMetal(const SampleGrid& grid, int y, Fields& f) const;
  void fillPatina(const SampleGrid& grid, int y, const std::vector<BlobField>& seeds,
                  Fields& f) const;

  std::uint64_t seed_;
  mutable RegularSurface regular_;
};

std::vector<BlobField> Copper::seeds(const Bounds& b) const {
  // seed, cell; chance; radius from, to, power; onset from, to, power; growth, power, elongation
  const BlobOptions classes[] = {
      {key(1), 19.0f, 0.80f, 10.0f, 19.0f, 1.0f, 0.16f, 0.55f, 1.0f, 0.95f, 1.15f, 1.0f},
      {key(2), 8.0f, 0.65f, 3.5f, 8.0f, 1.0f, 0.18f, 0.85f, 1.0f, 0.95f, 1.25f, 1.0f},
      {key(3), 2.6f, 0.60f, 0.5f, 2.2f, 2.0f, 0.20f, 1.05f, 1.0f, 0.90f, 1.50f, 1.0f},
  };
  std::vector<BlobField> fields;
  for (const BlobOptions& options : classes) fields.emplace_back(options, b.x0, b.y0, b.x1, b.y1);
  return fields;
}

void Copper::fillLiquid(const SampleGrid& grid, int y, const BlobField& patches, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise spread{key(10), 11, 4, 0.5f, 2.5f, 1}, warp_x{key(11), 9, 4},
      warp_y{key(12), 9, 4}, last{key(13), 13, 4}, pool{key(14), 7.5f, 2, 0.3f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    f.wetting[k] = 0.022f + 0.020f * std::clamp(spread.at(px, py, kAsIs), -0.8f, 0.8f);
    const Arrival dry =
        patches.at(px + 5.0f * warp_x.at(px, py, kAsIs), py + 5.0f * warp_y.at(px, py, kAsIs),
                   {kDryingTime, kDryingMm, 0.1f}, Arrival{});
    const float soft = 0.42f + 0.10f * last.at(px, py, kAsIs);  // what no patch reaches
    f.drying[k] = std::min(dry.time, soft);
    f.drying_inverse_width[k] = 1 / (dry.time < soft ? dry.width : 0.03f);
    const float phase = f.drying[k] * 13 + 0.5f * last.at(px + 40, py, kAsIs);
    const float crest = 1 - 2 * std::abs(phase - std::floor(phase) - 0.5f);
    f.pool[k] = kPoolMm * pool.at(px, py, texel);
    const float here = saturate(0.1f + 1.6f * spread.at(px, py + 90, kAsIs));
    f.tide[k] = here * crest * crest * crest;
  }
}

void Copper::fillMetal(const SampleGrid& grid, int y, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise brush{key(20), 0.6f, 4, 0.7f, 45, 1}, mottle{key(21), 5, 6, 0.6f},
      grain{key(22), 0.5f, 3, 0.7f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    f.brush[k] = brush.at(px, py, texel);
    f.mottle[k] = mottle.at(px, py, texel);
    f.grain[k] = grain.at(px, py, texel);
    f.relief[k] = 0.010f * f.brush[k];
    f.crust[k] = 0.030f * f.grain[k] + 0.03f * f.mottle[k];
  }
}

void Copper::fillPatina(const SampleGrid& grid, int y, const std::vector<BlobField>& seeds,
                        Fields& f) const {
  const FractalNoise warp_x{key(30), 10, 7, 0.55f}, warp_y{key(31), 10, 7, 0.55f},
      crest{key(32), 3.2f, 5, 0.6f}, early{key(33), 9, 5, 0.55f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const float wx = px + 5.0f * warp_x.at(px, py, kAsIs),
                wy = py + 5.0f * warp_y.at(px, py, kAsIs);
    const Rim rim{kRimTime, kRimMm, 0.3f, 0};
    Arrival first;
    for (const BlobField& field : seeds) first = field.at(wx, wy, rim, first);
    const float fingers = 0.34f * (0.52f - crest.ridged(px, py, kAsIs));
    f.patina[k] = std::max(first.time + fingers, 0.10f);
    const float anywhere = 0.26f + 0.30f * early.at(px, py, kAsIs);
    f.tarnish[k] = std::max(0.05f, std::min(anywhere, f.patina[k] - 0.14f) + 0.03f * f.mottle[k]);
  }
}

std::shared_ptr<const PreparedSurface> Copper::prepare(const SampleGrid& grid) const {
  const Bounds b = boundsOf(grid, 12);
  const std::vector<BlobField> patina = seeds(b);
  const BlobField patches({key(4), 21, 1, 15, 21, 1, 0.10f, 0.28f, 1, 0.40f, 1.1f, 1}, b.x0, b.y0,
                          b.x1, b.y1);
  Fields f(grid.x_mm.size());
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      fillMetal(grid, y, f);
      fillLiquid(grid, y, patches, f);
      fillPatina(grid, y, patina, f);
    }
  });
  differentiate(grid, f.drying, f.drying_dx, f.drying_dy, 0.05f);
  differentiate(grid, f.patina, f.patina_dx, f.patina_dy, 0.6f);
  for (std::size_t k = 0; k < f.patina.size(); ++k) {
    const float slope = std::hypot(f.patina_dx[k], f.patina_dy[k]);
    const float rim = std::min(std::hypot(kRimTime, kRimMm * slope), 0.3f);
    const float width = std::min(std::hypot(rim, 0.5f * grid.texel_mm * slope), 0.4f);
    f.patina[k] = std::max(f.patina[k] - (width - rim) / 2, 0.05f);
    f.patina_inverse_width[k] = 1 / width;
    const float gentle = std::min(1.0f, 0.10f / std::max(slope, 1e-6f));
    f.patina_dx[k] *= gentle;
    f.patina_dy[k] *= gentle;
  }
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 2.0f);
  differentiate(grid, f.pool, f.pool_dx, f.pool_dy, 1.0f);
  differentiate(grid, f.crust, f.crust_dx, f.crust_dy, 2.0f);
  return std::make_shared<CopperSurface>(grid.size.width, std::move(f));
}

}  // namespace

const SpecimenInfo& copperInfo() {
  static const SpecimenInfo info{"copper_patination",
                                 "brushed copper under a patinating liquid: bright, brown, green",
                                 std::chrono::hours(6), 60};
  return info;
}

std::unique_ptr<Specimen> makeCopper(std::uint64_t seed) { return std::make_unique<Copper>(seed); }

}  // namespace patina::devices::twin
