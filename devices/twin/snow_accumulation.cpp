// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of snow that gathers on a slate for twenty minutes, seen from above. Lengths
// in mm, times in shares of the process.
//
//   slate     bluish grey, cleft into thin layers (cleft_slate.h): terraces, each of a tone of its
//             own, with a fine ripple along the grain.
//   wetness   first flakes melt where they land and leave dark, glossy drops; slate is wet just
//             before snow covers it: its gloss rises and falls.
//   clumps    land within 2 % of the process and creep outward: two classes of spots and, from
//             sheltered places, patches (blobs.h), ragged by warping. Sheltered places are early,
//             crests late, so that edges and hollows are white first.
//   cover     a sheet that closes over what is left and rises; deepest on the lee side of ledges.
//             It drowns the relief below and the clumps, and has soft swells of its own.
//   snow      dark and glassy while thin and wet; then white, bluish in its hollows, grainy, matt.
//
// What it follows: Enrique et al., Time-varying textures, 2005 (snow on a slate tile, 20 min:
// section 4, figures 2 and 5). Shelter: the greatest slope upwind, Winstral, Elder and Davis,
// Spatial snow modeling of wind-redistributed snow using terrain-based parameters, 2002. Snow that
// settles, and white that hides the ground with depth: Fearing, Computer modelling of fallen snow,
// 2000. Albedo of new snow about 0.9, less in red: Warren, Optical properties of snow, 1982. Wet
// stone is darker: Lekner and Dorf, Why some things are darker when wet, 1988.
#include <algorithm>
#include <array>
#include <cmath>

#include "devices/twin/blobs.h"
#include "devices/twin/cleft_slate.h"
#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kStepMm = 0.75f;  // a layer of slate
constexpr float kEdgeMm = 0.85f;  // how wide a layer's edge is
constexpr float kRimTime = 0.012f, kRimMm = 0.22f;
constexpr float kSampleMm = 0.25f;
constexpr float kWettingTime = 0.03f;
constexpr float kClumpMm = 1.7f, kSettleTime = 0.040f;
constexpr float kRiseMm = 8.5f;                        // of the sheet, in the whole process
constexpr float kHideMm = 0.30f;                       // snow so deep hides half of what it lies on
constexpr float kDrownMm = 2.4f;                       // ... and half of its relief
constexpr float kSwellMm = 0.9f, kSwellShare = 0.25f;  // of swells, a mm of snow
constexpr float kGrainMm = 0.05f;

constexpr int kParts = 4;  // of a coarse texel: how snow reaches it, quarter by quarter

struct Fields {
  std::vector<float> tone, rust, form, form_dx, form_dy, relief, relief_dx, relief_dy;
  std::vector<float> wetting;
  std::vector<float> landing, landing_width, landing_dx, landing_dy;  // mean over the texel
  std::array<std::vector<float>, kParts> reached;                     // quarters, the first first
  std::vector<float> sheet, sheet_dx, sheet_dy;
  std::vector<float> swell, swell_dx, swell_dy, grain, grain_dx, grain_dy;
  explicit Fields(std::size_t n) {
    for (auto* f : {&tone,       &rust,      &form,     &form_dx,  &form_dy,       &relief,
                    &relief_dx,  &relief_dy, &wetting,  &landing,  &landing_width, &landing_dx,
                    &landing_dy, &sheet,     &sheet_dx, &sheet_dy, &swell,         &swell_dx,
                    &swell_dy,   &grain,     &grain_dx, &grain_dy})
      f->resize(n);
    for (auto& quarter : reached) quarter.resize(n);
  }
};

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float wet[kChunk];
  float covered[kChunk];                             // share that snow has reached
  float depth[kChunk];                               // of the snow, mm
  float landing_slope[kChunk], sheet_slope[kChunk];  // what an earlier time there adds to it
  float white[kChunk];                               // share of the snow in what is seen
};

class SnowSurface final : public PreparedSurface {
 public:
  SnowSurface(int width, bool fine, Fields fields)
      : width_(width), fine_(fine), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    Stage stage;
    const auto t = static_cast<float>(time);
    for (int x = 0; x < width_; x += kChunk) {
      const int count = std::min(kChunk, width_ - x);
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      if (fine_)
        advance<1>(t, at, count, stage);
      else
        advance<kParts>(t, at, count, stage);
      paint(t, at, count, stage, x, row);
      shape(at, count, stage, x, row);
    }
  }

 private:
  template <int kOf>
  void advance(float t, std::size_t at, int count, Stage& stage) const;
  void paint(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void shape(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  int width_;
  bool fine_;
  Fields f_;
};

// A fine texel is reached as one: all its quarters are the first.
template <int kOf>
void SnowSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *wetting = &f_.wetting[at], *width = &f_.landing_width[at], *sheet = &f_.sheet[at];
  std::array<const float*, kParts> reached{};
  for (int p = 0; p < kParts; ++p) reached[p] = &f_.reached[p][at];
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.wet[i] = smooth01(saturate((t - wetting[i]) / kWettingTime));
    // The sheet starts as slowly as a parabola; clumps stand out of it less and less. Both are low
    // where snow has only just come to lie.
    const float fallen = std::max(t - sheet[i], 0.0f), rise = fallen / (fallen + 0.12f);
    const float risen = kRiseMm * fallen * rise, inverse_width = 1 / width[i];
    const float full = risen + kClumpMm / (1 + risen * risen);
    float covered = 0, lying = 0, slope = 0, white = 0;
    for (int p = 0; p < kOf; ++p) {
      const float begun = std::max(t - reached[p][i], 0.0f), q = saturate(begun * inverse_width);
      const float cover = smooth01(q), since = begun - 0.5f * q * width[i];
      const float low = kSettleTime / (since + kSettleTime), settled = 1 - low * low;
      const float depth = full * settled * cover;
      covered += cover / kOf;
      lying += settled * cover / kOf;
      slope +=
          (2 * low * low * low / kSettleTime * cover + settled * 6 * q * (1 - q) * inverse_width) /
          kOf;
      white += cover * depth / (depth + kHideMm) / kOf;
    }
    stage.covered[i] = covered;
    stage.depth[i] = full * lying;
    stage.landing_slope[i] = full * slope;
    const float stands_less = 2 * kClumpMm * risen / ((1 + risen * risen) * (1 + risen * risen));
    stage.sheet_slope[i] = kRiseMm * rise * (2 - rise) * (1 - stands_less) * lying;
    stage.white[i] = white;
  }
}

void SnowSurface::paint(float t, std::size_t at, int count, const Stage& stage, int x,
                        SurfaceRow& row) const {
  const Rgb slate{0.078f, 0.090f, 0.108f}, rusty{0.115f, 0.088f, 0.066f};
  const Rgb snow{0.900f, 0.920f, 0.940f}, hollow{0.720f, 0.800f, 0.930f},
      slush{0.50f, 0.56f, 0.64f};
  const float *tone = &f_.tone[at], *rust = &f_.rust[at], *swell = &f_.swell[at],
              *grain = &f_.grain[at], *landing = &f_.landing[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *f0_r = row[SurfaceRow::kSpecularR] + x,
        *f0_g = row[SurfaceRow::kSpecularG] + x, *f0_b = row[SurfaceRow::kSpecularB] + x,
        *rough = row[SurfaceRow::kRoughness] + x, *degree = row[SurfaceRow::kDegree] + x;
  const float whole = smooth01(t);
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float wet = stage.wet[i], white = stage.white[i], covered = stage.covered[i];
    const float deep = saturate(stage.depth[i] * 0.8f);
    const Rgb stone = scaled(mix(slate, rusty, rust[i]), tone[i] * (1 - 0.52f * wet));
    const float lit = saturate(0.62f + 0.55f * swell[i] + 2.0f * grain[i]);
    const Rgb fresh = mix(slush, mix(hollow, snow, lit), deep);
    const Rgb c = mix(stone, fresh, white);
    r[i] = saturate(c.r);
    g[i] = saturate(c.g);
    b[i] = saturate(c.b);
    f0_r[i] = f0_g[i] = f0_b[i] = mix(mix(0.034f, 0.044f, wet), 0.020f, covered);
    const float grainy = mix(0.34f, 0.82f, deep) - 1.2f * grain[i];
    rough[i] = std::min(std::max(mix(mix(0.50f, 0.15f, wet), grainy, covered), 0.08f), 1.0f);
    const float since = saturate((t - landing[i]) / (1 - landing[i]));
    degree[i] = std::min(0.08f * wet + 0.42f * covered + 0.35f * since + 0.15f * whole, 1.0f);
  }
}

// Snow lies on the slate and drowns it.
void SnowSurface::shape(std::size_t at, int count, const Stage& stage, int x,
                        SurfaceRow& row) const {
  const float *form = &f_.form[at], *form_dx = &f_.form_dx[at], *form_dy = &f_.form_dy[at],
              *relief = &f_.relief[at], *relief_dx = &f_.relief_dx[at],
              *relief_dy = &f_.relief_dy[at], *landing_dx = &f_.landing_dx[at],
              *landing_dy = &f_.landing_dy[at], *sheet_dx = &f_.sheet_dx[at],
              *sheet_dy = &f_.sheet_dy[at], *swell = &f_.swell[at], *swell_dx = &f_.swell_dx[at],
              *swell_dy = &f_.swell_dy[at], *grain = &f_.grain[at], *grain_dx = &f_.grain_dx[at],
              *grain_dy = &f_.grain_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float depth = stage.depth[i], seen = kDrownMm / (depth + kDrownMm), seen2 = seen * seen;
    const float bare = seen * seen2, cover = stage.covered[i];
    const float swells = kSwellMm * std::min(depth * kSwellShare, 1.0f);
    // A deeper place is higher by the snow, lower by what drowns, higher by the swell.
    const float more_swell = depth * kSwellShare < 1 ? kSwellMm * kSwellShare * swell[i] : 0.0f;
    const float higher = 1 - relief[i] * 3 * seen2 * seen2 / kDrownMm + more_swell;
    const float landing = higher * stage.landing_slope[i], sheet = higher * stage.sheet_slope[i];
    const float dx = form_dx[i] + bare * relief_dx[i] - landing * landing_dx[i] -
                     sheet * sheet_dx[i] + swells * swell_dx[i] + cover * grain_dx[i];
    const float dy = form_dy[i] + bare * relief_dy[i] - landing * landing_dy[i] -
                     sheet * sheet_dy[i] + swells * swell_dy[i] + cover * grain_dy[i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = form[i] + bare * relief[i] + depth + swells * swell[i] + cover * grain[i];
  }
}

// Places a texel is asked at along either axis: 1, 2 or 4.
int samplesOf(const SampleGrid& grid) {
  return grid.texel_mm <= kSampleMm ? 1 : grid.texel_mm <= 2 * kSampleMm ? 2 : 4;
}

// When a point is reached by water and by snow.
struct Landing {
  float snow, water;
};

class Snow final : public Specimen {
 public:
  explicit Snow(std::uint64_t seed) : seed_(seed), slate_(key(1)) {}
  const SpecimenInfo& info() const override { return snowInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0x5e0full, field); }
  void fillSlate(const SampleGrid& grid, int y, Fields& f) const;
  void fillSnow(const SampleGrid& grid, int y, const std::vector<BlobField>& clumps,
                const BlobField& drops, Fields& f) const;
  Landing landingAt(float x, float y, float exposure, float sheet,
                    const std::vector<BlobField>& clumps, const BlobField& drops) const;
  void softenRims(const SampleGrid& grid, Fields& f) const;

  std::uint64_t seed_;
  CleftSlate slate_;
  mutable RegularSurface regular_;
};

void Snow::fillSlate(const SampleGrid& grid, int y, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise ripple{key(3), 7, 5, 0.6f, 5, 1}, mottle{key(4), 12, 5, 0.6f, 2, 1},
      stain{key(5), 30, 4, 0.6f, 2, 1}, pits{key(6), 2.2f, 3, 0.6f}, wear{key(9), 9, 3, 0.6f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k], layers = slate_.layersAt(px, py);
    const float slope = std::hypot(slate_.layersAt(px + 0.3f, py) - layers,
                                   slate_.layersAt(px, py + 0.3f) - layers) /
                        0.3f;
    const float edge = kEdgeMm * std::exp2(5 * wear.at(px, py, kAsIs));
    const float width = std::clamp(slope * std::hypot(edge, texel), 0.02f, 1.0f);
    const float step = cleft(layers, width);
    const auto toneOf = [&](float layer) {
      const auto n = static_cast<std::uint64_t>(static_cast<std::int64_t>(layer));
      return 0.72f + 0.56f * static_cast<float>(uniform(hashSeed(key(7), n)));
    };
    const float below = std::floor(layers);
    f.tone[k] = mix(toneOf(below), toneOf(below + 1), step - below) *
                (1 + 0.22f * mottle.at(px, py, texel) + 0.12f * ripple.at(px, py, texel));
    f.rust[k] = 0.6f * saturate(2.4f * stain.at(px, py, texel) - 0.5f);
    f.form[k] = kStepMm * slate_.formAt(px, py);
    f.relief[k] = kStepMm * step - f.form[k] + 0.16f * ripple.at(px, py, texel) +
                  0.05f * pits.at(px, py, texel);
  }
}

Landing Snow::landingAt(float x, float y, float exposure, float sheet,
                        const std::vector<BlobField>& clumps, const BlobField& drops) const {
  const FractalNoise warp_x{key(10), 6, 4, 0.48f}, warp_y{key(11), 6, 4, 0.48f},
      last{key(14), 7, 3, 0.5f};
  const float warped_x = 2.4f * warp_x.at(x, y, kAsIs), warped_y = 2.4f * warp_y.at(x, y, kAsIs);
  const Rim rim{kRimTime, kRimMm, 0.3f, 0};
  Arrival first;
  for (const BlobField& field : clumps) first = field.at(x + warped_x, y + warped_y, rim, first);
  const float closing = sheet + 0.14f + 0.10f * exposure + 0.13f * last.at(x, y, kAsIs);
  const float snow = std::clamp(std::min(first.time + 0.20f * exposure, closing), 0.03f, 0.85f);
  const Arrival drop = drops.at(x + 0.5f * warped_x, y + 0.5f * warped_y, rim, Arrival{});
  return {snow, std::min(drop.time, snow - 0.05f)};
}

void Snow::fillSnow(const SampleGrid& grid, int y, const std::vector<BlobField>& clumps,
                    const BlobField& drops, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise swell{key(12), 17, 5, 0.43f}, grain{key(13), 1.1f, 3, 0.75f},
      damp{key(15), 18, 3};
  const int samples = samplesOf(grid), places = samples * samples;
  const auto n = static_cast<float>(samples);
  std::vector<float> landings(static_cast<std::size_t>(places));
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k], exposure = slate_.exposureAt(px, py);
    f.sheet[k] = 0.42f + 0.24f * slate_.driftAt(px, py);
    float water = 0;
    for (int i = 0; i < places; ++i) {
      const int column = i % samples, row = i / samples;
      const float dx = (static_cast<float>(column) + 0.5f) / n - 0.5f,
                  dy = (static_cast<float>(row) + 0.5f) / n - 0.5f;
      const Landing at =
          landingAt(px + dx * texel, py + dy * texel, exposure, f.sheet[k], clumps, drops);
      landings[i] = at.snow;
      water += std::min(at.water, 1.0f) / (n * n);
    }
    std::sort(landings.begin(), landings.end());
    for (int i = 0; i < places * kParts; ++i)
      f.reached[i / places][k] += landings[i / kParts] / static_cast<float>(places);
    for (const auto& quarter : f.reached) f.landing[k] += quarter[k] / kParts;
    const float everywhere = 0.36f + 0.20f * damp.at(px, py, kAsIs);
    f.wetting[k] = std::max(std::min(water, everywhere), 0.005f);
    f.swell[k] = swell.at(px, py, texel);
    f.grain[k] = kGrainMm * grain.at(px, py, texel);
  }
}

// The rim of what lands: soft in space and time, and as wide as texels make it.
void Snow::softenRims(const SampleGrid& grid, Fields& f) const {
  differentiate(grid, f.landing, f.landing_dx, f.landing_dy, 0.6f);
  for (std::size_t k = 0; k < f.landing.size(); ++k) {
    const float slope = std::hypot(f.landing_dx[k], f.landing_dy[k]);
    const float rim = std::min(std::hypot(kRimTime, kRimMm * slope), 0.11f);
    const float width = std::min(std::hypot(rim, 0.5f * grid.texel_mm * slope), 0.11f);
    for (auto& quarter : f.reached) quarter[k] = std::max(quarter[k] - (width - rim) / 2, 0.02f);
    f.landing_width[k] = width;
    const float gentle = std::min(1.0f, 0.08f / std::max(slope, 1e-6f));
    f.landing_dx[k] *= gentle;
    f.landing_dy[k] *= gentle;
  }
}

std::shared_ptr<const PreparedSurface> Snow::prepare(const SampleGrid& grid) const {
  const Bounds b = boundsOf(grid, 12);
  // seed, cell; chance; radius from, to, power; onset from, to, power; growth, power
  const BlobOptions classes[] = {
      {key(20), 2.4f, 0.75f, 0.5f, 1.5f, 1.5f, 0.05f, 0.80f, 0.9f, 0.30f, 4.0f},  // flakes
      {key(21), 6.5f, 0.85f, 1.8f, 4.8f, 1.3f, 0.04f, 0.62f, 0.9f, 0.30f, 4.0f},  // clumps
      {key(22), 17.f, 0.70f, 6.0f, 14.f, 1.0f, 0.18f, 0.52f, 1.0f, 0.45f, 1.6f},  // patches
  };
  std::vector<BlobField> clumps;
  for (const BlobOptions& options : classes) clumps.emplace_back(options, b.x0, b.y0, b.x1, b.y1);
  const BlobField drops({key(23), 3.0f, 0.7f, 0.5f, 2.0f, 1.5f, 0.01f, 0.40f, 1, 0.02f, 1.5f}, b.x0,
                        b.y0, b.x1, b.y1);
  Fields f(grid.x_mm.size());
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      fillSlate(grid, y, f);
      fillSnow(grid, y, clumps, drops, f);
    }
  });
  softenRims(grid, f);
  differentiate(grid, f.form, f.form_dx, f.form_dy, 1.0f);
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 1.5f);
  differentiate(grid, f.sheet, f.sheet_dx, f.sheet_dy, 0.05f);
  differentiate(grid, f.swell, f.swell_dx, f.swell_dy, 0.5f);
  differentiate(grid, f.grain, f.grain_dx, f.grain_dy, 0.5f);
  return std::make_shared<SnowSurface>(grid.size.width, samplesOf(grid) == 1, std::move(f));
}

}  // namespace

const SpecimenInfo& snowInfo() {
  static const SpecimenInfo info{"snow_accumulation",
                                 "snow on cleft slate: wet, scattered clumps, drifts, all white",
                                 std::chrono::minutes(20), 120};
  return info;
}

std::unique_ptr<Specimen> makeSnow(std::uint64_t seed) { return std::make_unique<Snow>(seed); }

}  // namespace patina::devices::twin
