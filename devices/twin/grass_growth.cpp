// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of a tray of grass over four days, seen obliquely: up in the picture is away
// over the soil and up along the blades. Lengths in mm, times in shares of the process.
//
//   soil      (grass_soil.h) dark, moist, crumbly; seeds lie half sunk in it. It dries a little on
//             top, and goes dark under the blades.
//   blades    (grass_blades.h) sprout at different times from plants at every height of the plane,
//             so that the surface has no edge; lengthen by the logistic curve, widen, arch under
//             their weight and sway; pale yellow where young, deep green when grown. Those rooted
//             lower stand in front. Each shades what is close behind it.
//   light     falls off towards the roots as the canopy closes: a share of the albedo, so that a
//             picture without shadows has depth too.
//   degree    the local growth: a smooth field over the plane, not what covers a texel.
//
// What it follows: Enrique et al., Time-varying textures, 2005 (pet grass, photographed over days
// after three of germination: blades that elongate upward; section 4, figures 2 and 6). Growth:
// Richards, A flexible growth function for empirical use, 1959 (the logistic as its symmetric
// case); grass leaves lengthen at their base, so tips are oldest: Skinner and Nelson, Elongation of
// the grass leaf and its relationship to the phyllochron, 1995. Bending under own weight grows
// faster than length: Niklas, Plant biomechanics, 1992. Sway: Darwin, The power of movement in
// plants, 1880. Light under leaves: Monsi and Saeki 1953. Leaf reflectance around (0.05, 0.12,
// 0.03), brighter and yellower when young, a waxy gloss of index 1.5: Bousquet et al., Leaf BRDF
// measurements and model for specular and diffuse components differentiation, 2005.
#include <array>
#include <cmath>

#include "devices/twin/grass_blades.h"
#include "devices/twin/grass_soil.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kShadeMm = 1.2f, kShade = 0.30f;  // beside a blade, what is behind is darker
constexpr float kClimb = 0.20f;                   // height toward the camera a mm up a blade ...
constexpr float kFlatten = 0.0005f;               // ... less so towards the tip
constexpr float kSampleMm = 0.2f;                 // what lies as close is seen as one
constexpr float kHidden = 1e-3f;                  // what lies behind so much of it is not looked at
constexpr int kChunk = 16;
constexpr float kChunkMm = 3.3f;

struct Fields {
  std::vector<float> r, g, b, relief, relief_dx, relief_dy, seed, jitter;
  explicit Fields(std::size_t n) {
    for (auto* f : {&r, &g, &b, &relief, &relief_dx, &relief_dy, &seed, &jitter}) f->resize(n);
  }
};

// Places a texel is sampled at along either axis, so that what is seen depends little on its size.
int samplesOf(const SampleGrid& grid) {
  return std::clamp(static_cast<int>(std::ceil(grid.texel_mm / kSampleMm)), 1, 3);
}

// So many texels of a row are composed together: some millimetres, so that few blades matter.
int chunkOf(const SampleGrid& grid) {
  return std::clamp(4 * static_cast<int>(kChunkMm / grid.texel_mm / 4), 4, kChunk);
}

// Texels that are composed together, and the blades that ever matter to them.
struct Chunk {
  Bounds box;
  std::uint32_t first = 0, last = 0;  // of the list of blades
};

// What is seen of a few texels so far: the sum over what lies in front, and what comes through it
// from behind, of the values (clear) and, in the shade beside blades, of the light.
struct Stage {
  enum Value { kR, kG, kB, kGloss, kRough, kDx, kDy, kHeight, kValues };
  static constexpr int kLit = 4;  // the first four are of light
  float at[kValues][kChunk] = {};
  float light[kChunk], clear[kChunk];
};

class GrassSurface final : public PreparedSurface {
 public:
  GrassSurface(const SampleGrid& grid, Fields fields, const BladeField& blades);
  void rowAt(double time, int y, SurfaceRow& row) const override;

 private:
  using Blades = std::shared_ptr<const std::vector<BladeNow>>;
  Blades bladesAt(double time) const;
  void soil(float t, std::size_t at, int count, Stage& stage) const;
  void stand(const std::vector<const BladeNow*>& blades, std::size_t at, int count,
             Stage& stage) const;
  void compose(const BladeNow& blade, float dx, float dy, std::size_t at, int count,
               Stage& stage) const;
  void finish(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  SampleGrid grid_;
  int samples_, chunk_;
  Fields f_;
  std::vector<Blade> blades_;
  std::vector<Chunk> chunks_;  // [h][chunks a row]
  std::vector<std::uint32_t> near_;
  // Rows are asked for one by one: the blades of the last times asked for.
  mutable std::mutex mutex_;
  mutable std::array<std::pair<double, Blades>, 4> recent_;
  mutable std::size_t oldest_ = 0;
};

GrassSurface::GrassSurface(const SampleGrid& grid, Fields fields, const BladeField& blades)
    : grid_(grid),
      samples_(samplesOf(grid)),
      chunk_(chunkOf(grid)),
      f_(std::move(fields)),
      blades_(blades.blades()) {
  const float edge = grid.texel_mm / 2;
  for (int y = 0; y < grid.size.height; ++y)
    for (int x = 0; x < grid.size.width; x += chunk_) {
      const std::size_t begin = grid.index(x, y),
                        end =
                            begin + static_cast<std::size_t>(std::min(chunk_, grid.size.width - x));
      Bounds box{grid.x_mm[begin], grid.y_mm[begin], grid.x_mm[begin], grid.y_mm[begin]};
      for (std::size_t k = begin; k < end; ++k)
        box = {std::min(box.x0, grid.x_mm[k]), std::min(box.y0, grid.y_mm[k]),
               std::max(box.x1, grid.x_mm[k]), std::max(box.y1, grid.y_mm[k])};
      box = {box.x0 - edge, box.y0 - edge, box.x1 + edge, box.y1 + edge};
      const std::vector<std::uint32_t> here = blades.near(box);
      chunks_.push_back({box, static_cast<std::uint32_t>(near_.size()),
                         static_cast<std::uint32_t>(near_.size() + here.size())});
      near_.insert(near_.end(), here.begin(), here.end());
    }
}

GrassSurface::Blades GrassSurface::bladesAt(double time) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [when, blades] : recent_)
    if (blades && when == time) return blades;
  auto now = std::make_shared<std::vector<BladeNow>>();
  now->reserve(blades_.size());
  for (const Blade& blade : blades_) now->push_back(grown(blade, static_cast<float>(time)));
  recent_[oldest_] = {time, now};
  oldest_ = (oldest_ + 1) % recent_.size();
  return now;
}

// Whether it covers or shades something of the box now.
bool reaches(const BladeNow& b, const Bounds& box) {
  const float low = std::max(box.y0 - b.y, 0.0f), high = std::max(box.y1 - b.y, 0.0f);
  if (b.rise <= 0 || low > b.rise || box.y1 < b.y - kShadeMm) return false;
  const auto middle = [&](float h) {
    const float up = std::min(h, b.rise);
    return b.x + up * (b.lean + 0.5f * b.bend * up * b.inverse_rise);
  };
  const float steepest = std::max(std::abs(b.lean), std::abs(b.lean + b.bend));
  const float beside =
      (b.half_width + kShadeMm) * std::sqrt(1 + steepest * steepest) + steepest * (high - low);
  const float x = middle(low);
  return x + beside >= box.x0 && x - beside <= box.x1;
}

void GrassSurface::rowAt(double time, int y, SurfaceRow& row) const {
  const Blades blades = bladesAt(time);
  const auto t = static_cast<float>(time);
  const int width = grid_.size.width, chunks = (width + chunk_ - 1) / chunk_;
  std::vector<const BladeNow*> here;
  for (int c = 0; c < chunks; ++c) {
    const int x = c * chunk_, count = std::min(chunk_, width - x);
    const std::size_t at = grid_.index(x, y);
    const Chunk& chunk = chunks_[static_cast<std::size_t>(y) * chunks + c];
    here.clear();
    for (std::uint32_t i = chunk.last; i-- > chunk.first;) {  // the nearest first
      const BladeNow& blade = (*blades)[near_[i]];
      if (reaches(blade, chunk.box)) here.push_back(&blade);
    }
    Stage stage;
    soil(t, at, count, stage);
    if (!here.empty()) stand(here, at, count, stage);
    finish(t, at, count, stage, x, row);
  }
}

// The blades over the soil, averaged over samples_ x samples_ places of each texel.
void GrassSurface::stand(const std::vector<const BladeNow*>& blades, std::size_t at, int count,
                         Stage& stage) const {
  const Stage ground = stage;
  const auto n = static_cast<float>(samples_);
  const float share = 1 / (n * n);
  for (auto& value : stage.at) std::fill_n(value, count, 0.0f);
  for (int j = 0; j < samples_; ++j)
    for (int i = 0; i < samples_; ++i) {
      const float dx = ((static_cast<float>(i) + 0.5f) / n - 0.5f) * grid_.texel_mm,
                  dy = ((static_cast<float>(j) + 0.5f) / n - 0.5f) * grid_.texel_mm;
      Stage seen;
      std::fill_n(seen.light, count, 1.0f);
      std::fill_n(seen.clear, count, 1.0f);
      for (const BladeNow* blade : blades) {
        compose(*blade, dx, dy, at, count, seen);
        float clearest = 0;
        for (int k = 0; k < count; ++k) clearest = std::max(clearest, seen.clear[k]);
        if (clearest < kHidden) break;
      }
      for (int v = 0; v < Stage::kValues; ++v) {
        const float* through = v < Stage::kLit ? seen.light : seen.clear;
        for (int k = 0; k < count; ++k)
          stage.at[v][k] += share * (seen.at[v][k] + ground.at[v][k] * through[k]);
      }
    }
}

void GrassSurface::soil(float t, std::size_t at, int count, Stage& stage) const {
  const float *r = &f_.r[at], *g = &f_.g[at], *b = &f_.b[at], *relief = &f_.relief[at],
              *relief_dx = &f_.relief_dx[at], *relief_dy = &f_.relief_dy[at], *seed = &f_.seed[at],
              *jitter = &f_.jitter[at];
  const float dry = smooth01(saturate(t * 1.3f));
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float canopy = logistic01(ownTime(t, jitter[i]));
    const float light = (1 + 0.25f * dry) * (1 - 0.45f * smooth01(canopy));
    stage.at[Stage::kR][i] = r[i] * light;
    stage.at[Stage::kG][i] = g[i] * light;
    stage.at[Stage::kB][i] = b[i] * light;
    stage.at[Stage::kRough][i] = mix(mix(0.40f, 0.72f, dry), 0.50f, seed[i]);
    stage.at[Stage::kGloss][i] = 0.028f * (1 - 0.5f * dry) * (1 - 0.8f * canopy);
    stage.at[Stage::kDx][i] = relief_dx[i];
    stage.at[Stage::kDy][i] = relief_dy[i];
    stage.at[Stage::kHeight][i] = relief[i];
  }
}

// A blade behind what lies before it. Across, its edges and its surface are averaged over the
// texel.
void GrassSurface::compose(const BladeNow& blade, float dx, float dy, std::size_t at, int count,
                           Stage& stage) const {
  const BladeNow b = blade;
  const float *px = &grid_.x_mm[at], *py = &grid_.y_mm[at];
  const float texel = grid_.texel_mm / static_cast<float>(samples_), inverse_texel = 1 / texel;
  const float inverse_width = 1 / b.half_width, root_x = b.x - dx, root_y = b.y - dy;
  const float vein = std::max(1 - texel * 1.5f, 0.0f) * 0.16f;  // along the midrib; seen close by
  const float sheen = 4 * b.grown * (1 - b.grown);              // young leaves shine most
  const float gloss = 0.020f + 0.014f * sheen, rough = 0.58f - 0.24f * sheen;
  auto& [r, g, blue, shine, roughness, slope_x, slope_y, height] = stage.at;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float above = py[i] - root_y, q = saturate(above * b.inverse_rise), h = q * b.rise;
    const float slope = b.lean + b.bend * q;
    const float cosine = 1 / std::sqrt(1 + slope * slope);
    const float off = (px[i] - root_x - h * (b.lean + 0.5f * b.bend * q)) * cosine;
    const float q2 = q * q;
    const float half = b.half_width * (0.72f + 0.28f * std::min(5 * q, 1.0f)) * (1 - q2 * q2 * q);
    const float lo = std::max(off - 0.5f * texel, -half), hi = std::min(off + 0.5f * texel, half);
    const float ends =
        saturate(above * inverse_texel + 0.5f) * saturate((b.rise - above) * inverse_texel + 0.5f);
    const float cover = saturate((hi - lo) * inverse_texel) * ends;
    const float beside = saturate(1 - std::max(std::abs(off) - half, 0.0f) * (1 / kShadeMm));
    const float behind =
        (1 - kShade * beside * beside * (1 - q2) * saturate(h * 0.4f)) * (1 - cover);

    const float u = std::min(std::max(0.5f * (lo + hi) * inverse_width, -1.0f), 1.0f);
    const float light = mix(b.floor, 1, smooth01(saturate(h * b.inverse_canopy))) *
                        (1 + vein * (1 - 5 * u * u)) * cover;
    const float green = std::min(1.5f * q, 1.0f);
    const float lit = stage.light[i] * light, through = stage.clear[i] * cover;
    r[i] += mix(b.root.r, b.tip.r, green) * lit;
    g[i] += mix(b.root.g, b.tip.g, green) * lit;
    blue[i] += mix(b.root.b, b.tip.b, green) * lit;
    shine[i] += gloss * lit;
    const float turn = b.twist * (1 - 2 * q), across = b.fold * 2 * u + turn;
    roughness[i] += rough * through;
    slope_x[i] += across * cosine * through;
    slope_y[i] += (kClimb - 2 * kFlatten * h - across * slope * cosine) * through;
    const float surface = (b.fold * u + turn) * u * b.half_width;
    height[i] += (h * (kClimb - kFlatten * h) + 0.6f + surface) * through;
    stage.light[i] *= behind;
    stage.clear[i] *= 1 - cover;
  }
}

void GrassSurface::finish(float t, std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const float* jitter = &f_.jitter[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *f0_r = row[SurfaceRow::kSpecularR] + x,
        *f0_g = row[SurfaceRow::kSpecularG] + x, *f0_b = row[SurfaceRow::kSpecularB] + x,
        *rough = row[SurfaceRow::kRoughness] + x, *degree = row[SurfaceRow::kDegree] + x,
        *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    r[i] = saturate(stage.at[Stage::kR][i]);
    g[i] = saturate(stage.at[Stage::kG][i]);
    b[i] = saturate(stage.at[Stage::kB][i]);
    f0_r[i] = f0_g[i] = f0_b[i] = stage.at[Stage::kGloss][i];
    rough[i] = stage.at[Stage::kRough][i];
    const float dx = stage.at[Stage::kDx][i], dy = stage.at[Stage::kDy][i];
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = stage.at[Stage::kHeight][i];
    degree[i] = logistic01(ownTime(t, jitter[i]));
  }
}

class Grass final : public Specimen {
 public:
  explicit Grass(std::uint64_t seed) : seed_(seed) {}
  const SpecimenInfo& info() const override { return grassInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0x96a55ull, field); }
  void fillRow(const SampleGrid& grid, int y, Fields& f) const;

  std::uint64_t seed_;
  mutable RegularSurface regular_;
};

void Grass::fillRow(const SampleGrid& grid, int y, Fields& f) const {
  const GrowthJitter jitter(key(6));
  const GrassSoil ground(key(1));
  const int samples = samplesOf(grid);
  const auto n = static_cast<float>(samples);
  const float share = 1 / (n * n);
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    for (int j = 0; j < samples; ++j)
      for (int i = 0; i < samples; ++i) {
        const Soil s =
            ground.at(grid.x_mm[k] + ((static_cast<float>(i) + 0.5f) / n - 0.5f) * grid.texel_mm,
                      grid.y_mm[k] + ((static_cast<float>(j) + 0.5f) / n - 0.5f) * grid.texel_mm,
                      grid.texel_mm / n);
        f.r[k] += share * s.albedo.r;
        f.g[k] += share * s.albedo.g;
        f.b[k] += share * s.albedo.b;
        f.seed[k] += share * s.seed;
        f.relief[k] += share * s.relief;
      }
    f.jitter[k] = jitter.at(grid.x_mm[k], grid.y_mm[k]);
  }
}

std::shared_ptr<const PreparedSurface> Grass::prepare(const SampleGrid& grid) const {
  const BladeField blades(key(7), GrowthJitter(key(6)), boundsOf(grid, 4));
  Fields f(grid.x_mm.size());
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) fillRow(grid, y, f);
  });
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 1.6f);
  return std::make_shared<GrassSurface>(grid, std::move(f), blades);
}

}  // namespace

const SpecimenInfo& grassInfo() {
  static const SpecimenInfo info{"grass_growth",
                                 "grass from the seed: sprouts, blades that lengthen and arch",
                                 std::chrono::hours(4 * 24), 100};
  return info;
}

std::unique_ptr<Specimen> makeGrass(std::uint64_t seed) { return std::make_unique<Grass>(seed); }

}  // namespace patina::devices::twin
