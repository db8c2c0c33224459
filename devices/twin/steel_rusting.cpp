// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of bare ground steel that stands upright in wet, salty air for three days.
// Lengths in mm, times in shares of the process.
//
//   metal     bright, ground along x: anisotropic relief, reflectance and roughness.
//   haze      flash rust: a thin film that comes everywhere, in specks, and thickens to the end.
//   pits      four classes of seeds (blobs.h), from pinholes to wide patches, at positions warped
//             over seven octaves; they spread fast at first and merge. Attack is local where
//             chloride breaks the film and feeds itself, hence seeds (Evans, "The corrosion and
//             oxidation of metals", 1960).
//   runs      from some seeds water carries rust down the sheet (run_field.h), as on weathered
//             steel in the streets (Dorsey and Hanrahan, "Modeling and rendering of metallic
//             patinas", 1996; Chen et al., "Visual simulation of weathering by gamma-ton tracing",
//             2005).
//   crust     orange lepidocrocite first, then red-brown goethite, in the end dark magnetite below
//             (Misawa et al., "The mechanism of atmospheric rusting", 1974): the colour follows
//             the time since the rust came; matt, granular, thicker the older.
//
// Colours: iron reflects (0.56, 0.57, 0.58) at normal incidence by its measured index, ground steel
// a little less; rusts in linear light as photographs show them.
#include <cmath>

#include "devices/twin/blobs.h"
#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/run_field.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kRimMm = 0.12f;
constexpr float kRimTime = 0.020f;  // an onset takes at least so long
constexpr float kRunTime = 0.05f;
constexpr float kCrustMm = 0.16f;
constexpr float kThin = 0.35f, kSwell = 2.1f;  // a young crust; what an old one is thicker

struct Fields {
  std::vector<float> grind, mottle, grain;
  std::vector<float> haze, speck;
  std::vector<float> rust, rust_inverse_width, rust_dx, rust_dy;
  std::vector<float> run, run_strength;
  std::vector<float> relief, relief_dx, relief_dy, crust, crust_dx, crust_dy;
  explicit Fields(std::size_t n) {
    for (auto* f :
         {&grind, &mottle, &grain, &haze, &speck, &rust, &rust_inverse_width, &rust_dx, &rust_dy,
          &run, &run_strength, &relief, &relief_dx, &relief_dy, &crust, &crust_dx, &crust_dy})
      f->resize(n);
  }
};

// By the time since the rust came.
const ColorRamp<6>& rustRamp() {
  static const ColorRamp<6> ramp({{{0.00f, {0.360f, 0.145f, 0.040f}},
                                   {0.06f, {0.440f, 0.170f, 0.040f}},
                                   {0.18f, {0.330f, 0.105f, 0.028f}},
                                   {0.36f, {0.185f, 0.058f, 0.022f}},
                                   {0.58f, {0.090f, 0.036f, 0.020f}},
                                   {0.85f, {0.048f, 0.027f, 0.021f}}}});
  return ramp;
}

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float haze[kChunk];   // how far the film is, to 1 at the end
  float film[kChunk];   // what is seen of it
  float run[kChunk];    // strength of a stain
  float since[kChunk];  // rust came
  float rust_raw[kChunk], rust[kChunk];
};

class SteelSurface final : public PreparedSurface {
 public:
  SteelSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
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

void SteelSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *haze = &f_.haze[at], *rust = &f_.rust[at],
              *rust_inverse_width = &f_.rust_inverse_width[at], *run = &f_.run[at],
              *run_strength = &f_.run_strength[at], *speck = &f_.speck[at];
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.haze[i] = smooth01(saturate((t - haze[i]) / (1 - haze[i])));
    stage.film[i] = 0.8f * saturate(stage.haze[i] * (1.15f + 1.1f * speck[i]));
    stage.run[i] = run_strength[i] * smooth01(saturate((t - run[i]) / kRunTime));
    stage.rust_raw[i] = saturate((t - rust[i]) * rust_inverse_width[i]);
    stage.since[i] = t - rust[i] - 0.5f / rust_inverse_width[i];
    stage.rust[i] = smooth01(stage.rust_raw[i]);
  }
}

// Diffuse colour and degree.
void SteelSurface::paint(std::size_t at, int count, const Stage& stage, int x,
                         SurfaceRow& row) const {
  const ColorRamp<6> rusts = rustRamp();
  const Rgb metal{0.055f, 0.057f, 0.060f}, film{0.200f, 0.098f, 0.048f};
  const Rgb stain{0.340f, 0.135f, 0.035f};
  const float *mottle = &f_.mottle[at], *grain = &f_.grain[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *degree = row[SurfaceRow::kDegree] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float rust = stage.rust[i], run = stage.run[i];
    Rgb d = mix(metal, scaled(film, 1 + 0.35f * mottle[i]), stage.film[i]);
    d = mix(d, scaled(stain, 1 + 0.30f * mottle[i]), 0.95f * run);
    // Where the crust breaks, fresh rust shows again.
    const Rgb crust = rusts.at(stage.since[i] + 0.34f * mottle[i] - 0.22f * run);
    d = mix(d, scaled(crust, 1 + 0.28f * mottle[i] + 0.20f * grain[i]), rust);
    r[i] = saturate(d.r);
    g[i] = saturate(d.g);
    b[i] = saturate(d.b);
    degree[i] = 1 - (1 - stage.haze[i]) * (1 - 0.3f * run) *
                        (1 - rust * (0.4f + 0.6f * saturate(stage.since[i] * 2.5f)));
  }
}

// Specular colour and roughness.
void SteelSurface::finish(std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const Rgb metal{0.55f, 0.54f, 0.52f}, film{0.110f, 0.080f, 0.060f}, crust{0.030f, 0.028f, 0.027f};
  const float *grind = &f_.grind[at], *grain = &f_.grain[at];
  float *r = row[SurfaceRow::kSpecularR] + x, *g = row[SurfaceRow::kSpecularG] + x,
        *b = row[SurfaceRow::kSpecularB] + x, *roughness = row[SurfaceRow::kRoughness] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float rust = stage.rust[i], covered = 1 - (1 - stage.film[i]) * (1 - 0.8f * stage.run[i]);
    Rgb f0 = mix(scaled(metal, 1 + 0.22f * grind[i]), film, covered);
    f0 = mix(f0, crust, rust);
    r[i] = saturate(f0.r);
    g[i] = saturate(f0.g);
    b[i] = saturate(f0.b);
    const float rough = mix(0.34f + 0.08f * grind[i], 0.60f, covered);
    roughness[i] = std::max(saturate(mix(rough, 0.88f + 0.1f * grain[i], rust)), 0.05f);
  }
}

// Normal and height: grinding marks vanish under the crust.
void SteelSurface::shape(std::size_t at, int count, const Stage& stage, int x,
                         SurfaceRow& row) const {
  const float *relief = &f_.relief[at], *relief_dx = &f_.relief_dx[at],
              *relief_dy = &f_.relief_dy[at], *crust = &f_.crust[at], *crust_dx = &f_.crust_dx[at],
              *crust_dy = &f_.crust_dy[at], *rust_inverse_width = &f_.rust_inverse_width[at],
              *rust_dx = &f_.rust_dx[at], *rust_dy = &f_.rust_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float rust = stage.rust[i], s = stage.rust_raw[i];
    const float old = saturate(stage.since[i] * 2), thick = kThin + kSwell * old;
    const float body = kCrustMm + crust[i];
    // d (rust * thick) / d time, against the time since the rust came.
    const float swelling = stage.since[i] > 0 && old < 1 ? 2 * kSwell * rust : 0;
    const float grow = body * (6 * s * (1 - s) * rust_inverse_width[i] * thick + swelling);
    const float bare = 1 - 0.85f * rust;
    const float dx = bare * relief_dx[i] + rust * thick * crust_dx[i] - grow * rust_dx[i];
    const float dy = bare * relief_dy[i] + rust * thick * crust_dy[i] - grow * rust_dy[i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = bare * relief[i] + rust * thick * body;
  }
}

class Steel final : public Specimen {
 public:
  explicit Steel(std::uint64_t seed) : seed_(seed) {}
  const SpecimenInfo& info() const override { return steelInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0x57ee1ull, field); }
  std::vector<BlobField> seeds(const Bounds& b) const;
  void fillMetal(const SampleGrid& grid, int y, Fields& f) const;
  void fillRust(const SampleGrid& grid, int y, const std::vector<BlobField>& seeds,
                const RunField& runs, Fields& f) const;

  std::uint64_t seed_;
  mutable RegularSurface regular_;
};

std::vector<BlobField> Steel::seeds(const Bounds& b) const {
  // seed, cell; chance; radius from, to, power; onset from, to, power; growth, power, elongation
  const BlobOptions classes[] = {
      {key(1), 17.0f, 0.70f, 7.0f, 17.0f, 1.3f, 0.16f, 0.55f, 1.0f, 0.75f, 1.15f, 1.0f},
      {key(2), 7.0f, 0.60f, 2.2f, 7.0f, 1.5f, 0.12f, 0.80f, 0.9f, 0.85f, 1.30f, 1.0f},
      {key(3), 2.5f, 0.55f, 0.4f, 2.2f, 2.0f, 0.08f, 0.95f, 0.8f, 0.75f, 1.60f, 1.0f},
      {key(4), 1.0f, 0.30f, 0.18f, 0.5f, 2.0f, 0.06f, 0.95f, 0.7f, 0.60f, 1.80f, 1.0f},
  };
  std::vector<BlobField> fields;
  for (const BlobOptions& options : classes) fields.emplace_back(options, b.x0, b.y0, b.x1, b.y1);
  return fields;
}

void Steel::fillMetal(const SampleGrid& grid, int y, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise grind{key(20), 0.8f, 5, 0.75f, 30, 1}, mottle{key(21), 7, 6, 0.52f},
      grain{key(22), 0.55f, 3, 0.75f}, speck{key(24), 4.0f, 6, 0.85f},
      lumps{key(23), 1.3f, 3, 0.6f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    f.grind[k] = grind.at(px, py, texel);
    f.mottle[k] = mottle.at(px, py, texel);
    f.grain[k] = grain.at(px, py, texel);
    f.speck[k] = 0.5f * speck.at(px, py, texel);
    f.relief[k] = 0.008f * f.grind[k];
    f.crust[k] = 0.055f * f.grain[k] + 0.085f * lumps.at(px, py, texel);
  }
}

void Steel::fillRust(const SampleGrid& grid, int y, const std::vector<BlobField>& seeds,
                     const RunField& runs, Fields& f) const {
  const FractalNoise warp_x{key(30), 8, 7, 0.60f}, warp_y{key(31), 8, 7, 0.60f},
      fray{key(32), 2.2f, 4, 0.60f}, early{key(33), 12, 4, 0.5f};
  const float warps[] = {5.0f, 2.6f, 0.8f, 0.3f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const float wx = warp_x.at(px, py, kAsIs), wy = warp_y.at(px, py, kAsIs);
    const Rim rim{kRimTime, kRimMm, 0.3f, 0};
    Arrival first;
    for (std::size_t i = 0; i < seeds.size(); ++i)
      first = seeds[i].at(px + warps[i] * wx, py + warps[i] * wy, rim, first);
    const float frays = 0.22f * fray.at(px, py, kAsIs);
    f.rust[k] = std::min(first.time, 1.6f) + frays;
    f.haze[k] = std::clamp(0.14f + 0.20f * early.at(px, py, kAsIs), 0.03f, 0.4f);
    const Run run = runs.at(px + 0.5f * wx, py, grid.texel_mm);
    f.run[k] = std::min(run.time, 2.0f);
    f.run_strength[k] = saturate(run.strength * (1.1f + 0.9f * fray.at(px, py * 0.2f, kAsIs)));
    // A pit where the run begins, and crust where it has been wet for long.
    const float source = run.source_onset - 0.12f + 0.30f * std::pow(run.source_mm / 1.6f, 1.6f);
    const float below = f.run[k] + 0.55f - 0.40f * f.run_strength[k];
    f.rust[k] = std::min({f.rust[k], source + frays, below + frays});
    f.rust[k] = std::max(f.rust[k], 0.04f);
  }
}

std::shared_ptr<const PreparedSurface> Steel::prepare(const SampleGrid& grid) const {
  const Bounds b = boundsOf(grid, 14);
  const std::vector<BlobField> pits = seeds(b);
  const RunField runs({key(5), 6.0f, 0.55f, 10, 46, 0.30f, 1.3f, 0.18f, 0.75f, 0.30f}, b.x0, b.y0,
                      b.x1, b.y1);
  Fields f(grid.x_mm.size());
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      fillMetal(grid, y, f);
      fillRust(grid, y, pits, runs, f);
    }
  });
  soften(grid, {kRimTime, kRimMm, 0.3f, 0.6f}, f.rust, f.rust_inverse_width, f.rust_dx, f.rust_dy);
  for (float& rust : f.rust) rust = std::max(rust, 0.03f);
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 2.0f);
  differentiate(grid, f.crust, f.crust_dx, f.crust_dy, 1.0f);
  return std::make_shared<SteelSurface>(grid.size.width, std::move(f));
}

}  // namespace

const SpecimenInfo& steelInfo() {
  static const SpecimenInfo info{"steel_rusting",
                                 "ground steel in wet air: bright, pitted, run down with rust",
                                 std::chrono::hours(3 * 24), 60};
  return info;
}

std::unique_ptr<Specimen> makeSteel(std::uint64_t seed) { return std::make_unique<Steel>(seed); }

}  // namespace patina::devices::twin
