// SPDX-License-Identifier: GPL-3.0-or-later
// A generative model of red acrylic paint over a crackle medium on a pine board, over two hours
// (the sample of Enrique et al., "Time-varying textures", 2005). Lengths in mm, times in shares of
// the process.
//
//   film      brushed along the grain, which runs along y; wet paint levels and gleams, then a
//   front
//             withdraws over it: the milky colour of wet acrylic deepens, the gloss goes. Drying
//             runs in from patches, as water leaves a film from its edges (Routh and Russel,
//             "Horizontal drying fronts during solvent evaporation from latex films", 1998).
//   cracks    crack_network.h: long ones along the grain first, each in a few hundredths of the
//             process, then ever shorter ones between them. A crack opens fast at first, w ~
//             t^0.45, and shows pine: a dark line while narrow, pale wood once light falls in.
//   plates    dry faster above than below, so their edges curl up: a rim whose height falls with
//             the square of the distance to the crack and rises as the crack opens.
//   strain    of the film, everywhere, to the end: what the degree counts beside drying and gaps.
//
// Colours: sRGB as photographs of such boards show them; acrylic has an index of 1.49, so 0.04.
#include <cmath>

#include "devices/twin/blobs.h"
#include "devices/twin/crack_network.h"
#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kLevelling = 0.05f;  // wet paint flows out
constexpr float kDryTime = 0.015f;   // the front passes a place
constexpr float kDryMm = 0.6f;       // how wide it is
constexpr float kGapTime = 0.020f;   // least time in which a texel opens
constexpr float kFilmMm = 0.34f;
constexpr float kWetMm = 0.10f;  // thicker while wet
constexpr float kWallSlope = 2;  // at most
constexpr float kCurlLag = 0.02f, kCurlTime = 0.30f;
constexpr float kCurlMm[kCrackLevels] = {0.48f, 0.30f, 0.10f};
constexpr float kCurlReachMm[kCrackLevels] = {2.8f, 1.9f, 0.9f};

struct Curl {
  std::vector<float> time, rim, rim_dx, rim_dy;
};
struct Fields {
  std::vector<float> streak, mottle, wood, strain;
  std::vector<float> drying, drying_inverse_width;
  std::vector<float> gap, gap_inverse_width, gap_share, gap_origin, gap_end, gap_time, gap_dx,
      gap_dy;
  std::vector<float> relief, relief_dx, relief_dy, fibre, fibre_dx, fibre_dy;
  Curl curl[kCrackLevels];
  explicit Fields(std::size_t n) {
    for (auto* f : {&streak,    &mottle,
                    &wood,      &strain,
                    &drying,    &drying_inverse_width,
                    &gap,       &gap_inverse_width,
                    &gap_share, &gap_origin,
                    &gap_end,   &gap_time,
                    &gap_dx,    &gap_dy,
                    &relief,    &relief_dx,
                    &relief_dy, &fibre,
                    &fibre_dx,  &fibre_dy})
      f->resize(n);
    for (Curl& c : curl)
      for (auto* f : {&c.time, &c.rim, &c.rim_dx, &c.rim_dy}) f->resize(n);
  }
};

// A gap grows at once, then ever more slowly.
inline float opened(float s) { return s * (2 - s); }

// What a few texels of a row are made of at one time.
constexpr int kChunk = 128;
struct Stage {
  float dried[kChunk];
  float gap_raw[kChunk], gap[kChunk];  // share of the texel that is gap
  float lit[kChunk];                   // how much light falls to its ground
  float strain[kChunk];
  float curl[kChunk], curl_dx[kChunk], curl_dy[kChunk];
};

class PaintSurface final : public PreparedSurface {
 public:
  PaintSurface(int width, Fields fields) : width_(width), f_(std::move(fields)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    Stage stage;
    const auto t = static_cast<float>(time);
    for (int x = 0; x < width_; x += kChunk) {
      const int count = std::min(kChunk, width_ - x);
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      advance(t, at, count, stage);
      bend(t, at, count, stage);
      paint(at, count, stage, x, row);
      finish(t, at, count, stage, x, row);
      shape(t, at, count, stage, x, row);
    }
  }

 private:
  void advance(float t, std::size_t at, int count, Stage& stage) const;
  void bend(float t, std::size_t at, int count, Stage& stage) const;
  void paint(std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void finish(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;
  void shape(float t, std::size_t at, int count, const Stage& stage, int x, SurfaceRow& row) const;

  int width_;
  Fields f_;
};

void PaintSurface::advance(float t, std::size_t at, int count, Stage& stage) const {
  const float *drying = &f_.drying[at], *drying_inverse_width = &f_.drying_inverse_width[at],
              *gap = &f_.gap[at], *gap_inverse_width = &f_.gap_inverse_width[at],
              *gap_share = &f_.gap_share[at], *gap_origin = &f_.gap_origin[at],
              *gap_end = &f_.gap_end[at], *strain = &f_.strain[at];
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    stage.dried[i] = smooth01(saturate((t - drying[i]) * drying_inverse_width[i]));
    stage.gap_raw[i] = saturate((t - gap[i]) * gap_inverse_width[i]);
    stage.gap[i] = gap_share[i] * opened(stage.gap_raw[i]);
    const float age = std::max(t - gap_origin[i], 1e-3f);
    // 0 at the edge, 1 in the middle; of what the texel covers, the nearest and the farthest.
    const float inside = 0.76f * saturate(1.2f * (t - gap[i]) / age) +
                         0.24f * saturate(1.2f * (t - gap_end[i]) / age);
    stage.lit[i] = inside * smooth01(saturate(age * 3.5f));
    stage.strain[i] = smooth01(saturate((t - strain[i]) / (1 - strain[i])));
  }
}

// Edges of plates.
void PaintSurface::bend(float t, std::size_t at, int count, Stage& stage) const {
  std::fill_n(stage.curl, count, 0.0f);
  std::fill_n(stage.curl_dx, count, 0.0f);
  std::fill_n(stage.curl_dy, count, 0.0f);
  for (const Curl& c : f_.curl) {
    const float *time = &c.time[at], *rim = &c.rim[at], *rim_dx = &c.rim_dx[at],
                *rim_dy = &c.rim_dy[at];
    PATINA_INDEPENDENT_TEXELS
    for (int i = 0; i < count; ++i) {
      const float risen = smooth01(saturate((t - time[i] - kCurlLag) / kCurlTime));
      stage.curl[i] += risen * rim[i];
      stage.curl_dx[i] += risen * rim_dx[i];
      stage.curl_dy[i] += risen * rim_dy[i];
    }
  }
}

// Diffuse colour and degree.
void PaintSurface::paint(std::size_t at, int count, const Stage& stage, int x,
                         SurfaceRow& row) const {
  const Rgb wet_paint{0.380f, 0.030f, 0.022f}, dry_paint{0.310f, 0.015f, 0.011f};
  const Rgb pine{0.630f, 0.460f, 0.275f}, shadow{0.040f, 0.018f, 0.012f};
  const float *streak = &f_.streak[at], *mottle = &f_.mottle[at], *wood = &f_.wood[at];
  float *r = row[SurfaceRow::kDiffuseR] + x, *g = row[SurfaceRow::kDiffuseG] + x,
        *b = row[SurfaceRow::kDiffuseB] + x, *degree = row[SurfaceRow::kDegree] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float dried = stage.dried[i], gap = stage.gap[i], strain = stage.strain[i];
    Rgb d = mix(wet_paint, dry_paint, dried);
    d = scaled(d, 1 + 0.22f * streak[i] * (0.5f + 0.5f * dried) + 0.12f * mottle[i] +
                      0.35f * stage.curl[i]);  // a lifted edge is worn
    const Rgb below = mix(shadow, scaled(pine, 1 + 0.5f * wood[i]), 0.10f + 0.90f * stage.lit[i]);
    d = mix(d, below, gap);
    r[i] = saturate(d.r);
    g[i] = saturate(d.g);
    b[i] = saturate(d.b);
    degree[i] = 1 - (1 - 0.25f * dried) * (1 - 0.85f * gap) * (1 - strain);
  }
}

// Specular colour and roughness.
void PaintSurface::finish(float t, std::size_t at, int count, const Stage& stage, int x,
                          SurfaceRow& row) const {
  const float levelled = smooth01(saturate(t / kLevelling));
  const float rough_wet = mix(0.30f, 0.075f, levelled);
  const float *streak = &f_.streak[at], *mottle = &f_.mottle[at];
  float *r = row[SurfaceRow::kSpecularR] + x, *g = row[SurfaceRow::kSpecularG] + x,
        *b = row[SurfaceRow::kSpecularB] + x, *roughness = row[SurfaceRow::kRoughness] + x;
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float gap = stage.gap[i];
    const float f0 = mix(mix(0.044f, 0.040f, stage.dried[i]), 0.020f, gap);
    r[i] = g[i] = b[i] = f0;
    const float satin = 0.36f + 0.16f * stage.strain[i] + 0.06f * mottle[i] + 0.05f * streak[i];
    roughness[i] = saturate(mix(mix(rough_wet, satin, stage.dried[i]), 0.80f, gap));
  }
}

void PaintSurface::shape(float t, std::size_t at, int count, const Stage& stage, int x,
                         SurfaceRow& row) const {
  const float *gap_dx = &f_.gap_dx[at], *gap_dy = &f_.gap_dy[at], *gap_share = &f_.gap_share[at],
              *gap_inverse_width = &f_.gap_inverse_width[at], *relief = &f_.relief[at],
              *relief_dx = &f_.relief_dx[at], *relief_dy = &f_.relief_dy[at],
              *fibre = &f_.fibre[at], *fibre_dx = &f_.fibre_dx[at], *fibre_dy = &f_.fibre_dy[at];
  float *nx = row[SurfaceRow::kNormalX] + x, *ny = row[SurfaceRow::kNormalY] + x,
        *nz = row[SurfaceRow::kNormalZ] + x, *height = row[SurfaceRow::kHeight] + x;
  const float levelled = smooth01(saturate(t / kLevelling));
  PATINA_INDEPENDENT_TEXELS
  for (int i = 0; i < count; ++i) {
    const float s = stage.gap_raw[i], gap = stage.gap[i], film = 1 - gap;
    const float strokes = mix(1, mix(0.35f, 0.75f, stage.dried[i]), levelled);
    const float top = kFilmMm + kWetMm * (1 - stage.dried[i]) + strokes * relief[i] + stage.curl[i];
    // The height falls where the gap has opened: - d height / d time of opening.
    const float wall = 2 * (1 - s) * std::min(s * 8, 1.0f) * gap_share[i] * gap_inverse_width[i] *
                       (top - fibre[i]);
    const float dx = film * (strokes * relief_dx[i] + stage.curl_dx[i]) + gap * fibre_dx[i] +
                     std::min(std::max(wall * gap_dx[i], -kWallSlope), kWallSlope);
    const float dy = film * (strokes * relief_dy[i] + stage.curl_dy[i]) + gap * fibre_dy[i] +
                     std::min(std::max(wall * gap_dy[i], -kWallSlope), kWallSlope);
    const float inverse = 1 / std::sqrt(1 + dx * dx + dy * dy);
    nx[i] = -dx * inverse;
    ny[i] = -dy * inverse;
    nz[i] = inverse;
    height[i] = mix(top, fibre[i], gap);
  }
}

class Paint final : public Specimen {
 public:
  explicit Paint(std::uint64_t seed) : seed_(seed) {}
  const SpecimenInfo& info() const override { return paintInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override;
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::uint64_t key(std::uint64_t field) const { return hashSeed(seed_, 0x9a17ull, field); }
  void fillFilm(const SampleGrid& grid, int y, const BlobField& patches, Fields& f) const;
  void fillCracks(const SampleGrid& grid, int y, const CrackNetwork& network, Fields& f) const;

  std::uint64_t seed_;
  mutable RegularSurface regular_;
};

void Paint::fillFilm(const SampleGrid& grid, int y, const BlobField& patches, Fields& f) const {
  const float texel = grid.texel_mm;
  const FractalNoise brush{key(10), 1.1f, 4, 0.62f, 1, 26}, mottle{key(11), 7, 5, 0.55f},
      warp_x{key(12), 11, 4}, warp_y{key(13), 11, 4}, last{key(14), 16, 3},
      ring{key(15), 2.6f, 3, 0.6f, 1, 18}, fibre{key(16), 0.5f, 3, 0.6f, 1, 14},
      strain{key(17), 9, 3};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    f.streak[k] = brush.at(px, py, texel);
    f.mottle[k] = mottle.at(px, py, texel);
    const float fibres = fibre.at(px, py, texel);
    f.wood[k] = 0.7f * ring.at(px, py, texel) + 0.4f * fibres;
    f.relief[k] = 0.028f * f.streak[k] + 0.012f * f.mottle[k];
    f.fibre[k] = 0.020f * fibres;
    f.strain[k] = std::clamp(0.22f + 0.25f * strain.at(px, py, kAsIs), 0.05f, 0.5f);
    const Arrival dry =
        patches.at(px + 5 * warp_x.at(px, py, kAsIs), py + 5 * warp_y.at(px, py, kAsIs),
                   {kDryTime, kDryMm, 0.06f, texel}, Arrival{});
    const float soft = 0.17f + 0.05f * last.at(px, py, kAsIs);  // what no patch reaches
    f.drying[k] = std::min(dry.time, soft);
    f.drying_inverse_width[k] = 1 / (dry.time < soft ? dry.width : 0.03f);
  }
}

void Paint::fillCracks(const SampleGrid& grid, int y, const CrackNetwork& network,
                       Fields& f) const {
  const CrackOptions nominal;
  const float half = 0.5f * grid.texel_mm;
  const FractalNoise ragged_x{key(20), 1.9f, 5, 0.6f}, ragged_y{key(21), 1.9f, 5, 0.6f};
  for (int x = 0; x < grid.size.width; ++x) {
    const std::size_t k = grid.index(x, y);
    const float px = grid.x_mm[k], py = grid.y_mm[k];
    const auto places = network.nearest(px + 0.32f * ragged_x.at(px, py, kAsIs),
                                        py + 0.32f * ragged_y.at(px, py, kAsIs));
    f.gap[k] = f.gap_origin[k] = f.gap_end[k] = 9;
    f.gap_inverse_width[k] = 1;
    f.gap_share[k] = 0;
    f.gap_time[k] = 2;
    float best = 0;
    for (int level = 0; level < kCrackLevels; ++level) {
      const CrackPlace& c = places[level];
      Curl& curl = f.curl[level];
      curl.time[k] = c.time;
      const float far = std::max(1 - c.distance_mm / kCurlReachMm[level], 0.0f);
      const float strength =
          std::min(c.half_width_mm / (0.7f * nominal.half_width_mm[level]), 1.2f);
      curl.rim[k] = kCurlMm[level] * strength * far * far;
      f.gap_time[k] = std::min(f.gap_time[k], CrackNetwork::timeAt(c, c.distance_mm));
      // The share of a texel that a strip of half width w covers grows until w is open at the end.
      const float open = CrackNetwork::openAt(c, 1);
      const float from = std::max(c.distance_mm - half, 0.0f);
      if (from >= open) continue;
      const float left = std::max(c.distance_mm - half, -open),
                  right = std::min(c.distance_mm + half, open);
      const float share = saturate((right - left) / (2 * half));
      const float begin = CrackNetwork::timeAt(c, from), end = CrackNetwork::timeAt(c, right);
      const float score = share * (1.2f - 0.5f * (begin + end));
      if (score <= best) continue;
      best = score;
      const float width = std::max(end - begin, kGapTime);
      f.gap[k] = begin;
      f.gap_origin[k] = c.time;
      f.gap_end[k] = end;
      f.gap_inverse_width[k] = 1 / width;
      f.gap_share[k] = share;
    }
  }
}

std::shared_ptr<const PreparedSurface> Paint::prepare(const SampleGrid& grid) const {
  const Bounds b = boundsOf(grid, 12);
  const BlobField patches({key(1), 24, 1, 16, 24, 1, 0.035f, 0.11f, 1, 0.14f, 1.1f, 1}, b.x0, b.y0,
                          b.x1, b.y1);
  CrackOptions options;
  options.seed = key(2);
  const CrackNetwork network(options);
  Fields f(grid.x_mm.size());
  forRowBlocks(grid.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      fillFilm(grid, y, patches, f);
      fillCracks(grid, y, network, f);
    }
  });
  differentiate(grid, f.gap_time, f.gap_dx, f.gap_dy, 2.0f);
  differentiate(grid, f.relief, f.relief_dx, f.relief_dy, 1.0f);
  differentiate(grid, f.fibre, f.fibre_dx, f.fibre_dy, 1.0f);
  for (Curl& c : f.curl) differentiate(grid, c.rim, c.rim_dx, c.rim_dy, 0.4f);
  return std::make_shared<PaintSurface>(grid.size.width, std::move(f));
}

}  // namespace

const SpecimenInfo& paintInfo() {
  static const SpecimenInfo info{"paint_cracking",
                                 "red paint over a crackle medium: wet, dry, cracked and curled",
                                 std::chrono::hours(2), 60};
  return info;
}

std::unique_ptr<Specimen> makePaint(std::uint64_t seed) { return std::make_unique<Paint>(seed); }

}  // namespace patina::devices::twin
