// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/calibration/registration/twin_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "devices/twin/specimen_pose.h"
#include "processing/image/dng_file.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/parallel_rows.h"
#include "processing/image/random.h"

namespace patina::calibration {

using namespace devices::twin;

namespace {

constexpr Nanoseconds kRun = std::chrono::hours(100);

// A lamp from the upper left, diffuse reflection, full well at 1.2. `surface` has `across` points
// to a pixel across, each without what is finer than they are apart: a pixel sees their mean.
std::vector<float> lightOf(const PreparedSurface& surface, double time, SizePx size, int across) {
  std::vector<float> light(static_cast<std::size_t>(size.width) * size.height);
  forEachRow(size.height, std::int64_t{1} << 16, [&](int y) {
    SurfaceRow row(size.width * across);
    float* seen = &light[static_cast<std::size_t>(y) * size.width];
    for (int j = 0; j < across; ++j) {
      surface.rowAt(time, y * across + j, row);
      for (int k = 0; k < row.width(); ++k) {
        const int x = k / across;
        const float lit = -0.5f * row[SurfaceRow::kNormalX][k] +
                          0.3f * row[SurfaceRow::kNormalY][k] +
                          0.81f * row[SurfaceRow::kNormalZ][k];
        const auto colour =
            static_cast<SurfaceRow::Channel>(SurfaceRow::kDiffuseR + (x & 1) + (y & 1));
        seen[x] += row[colour][k] * std::max(lit, 0.0f);
      }
    }
    for (int x = 0; x < size.width; ++x) seen[x] /= static_cast<float>(across * across);
  });
  return light;
}

double electronsPerLight() { return referenceProfile().sensor.full_well / 1.2; }

Image<float> readOut(const ImageSensor& sensor, std::vector<float> light, std::uint64_t seed) {
  const SensorProfile& profile = referenceProfile().sensor;
  const SizePx size = sensor.size();
  SensorShot shot;
  shot.electrons_per_light = static_cast<float>(electronsPerLight());
  shot.exposure = profile.grey_exposure;
  shot.noise_key = hashSeed(seed, 77);
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    sensor.readRow(y, &light[static_cast<std::size_t>(y) * size.width], shot,
                   raw.samples.view().row(y));
  raw.black_level = profile.black_level;
  raw.white_level = profile.whiteLevel();
  return demosaic(raw);
}

double sample(const std::vector<float>& values, SizePx size, double x, double y) {
  if (!(x >= 0 && y >= 0 && x <= size.width - 1 && y <= size.height - 1))
    return std::numeric_limits<double>::quiet_NaN();
  const int x0 = std::min(static_cast<int>(x), size.width - 2),
            y0 = std::min(static_cast<int>(y), size.height - 2);
  const double fx = x - x0, fy = y - y0;
  const auto at = [&](int i, int j) -> double {
    return values[static_cast<std::size_t>(j) * size.width + i];
  };
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

}  // namespace

ShiftedSpecimen::ShiftedSpecimen(const std::string& name, SizePx size, int points)
    : specimen_(makeSpecimen(name, 1)),
      size_(size),
      points_(points),
      sensor_(std::make_unique<ImageSensor>(size, referenceProfile().sensor,
                                            lensFalloff(size, referenceProfile().lens), 5)),
      flat_(size.width, size.height, 3) {
  constexpr int kFlats = 16;
  for (std::uint64_t k = 0; k < kFlats; ++k) {
    const Image<float> white = readOut(
        *sensor_, std::vector<float>(static_cast<std::size_t>(size.width) * size.height, 0.8f),
        1000 + k);
    for (std::size_t i = 0; i < flat_.texels().size(); ++i)
      flat_.texels()[i] += white.texels()[i] / kFlats;
  }
}

std::vector<float> ShiftedSpecimen::lightAt(double time, PlacePx shift) const {
  SampleGrid grid = SampleGrid::regular({size_.width * points_, size_.height * points_},
                                        specimen_->info().width_mm);
  const double pixel_mm = specimen_->info().width_mm / size_.width;
  for (float& x : grid.x_mm) x -= static_cast<float>(shift.x * pixel_mm);
  for (float& y : grid.y_mm) y += static_cast<float>(shift.y * pixel_mm);  // y is up there
  return lightOf(*specimen_->prepare(grid), time, size_, points_);
}

Image<float> ShiftedSpecimen::developed(const std::vector<float>& light, std::uint64_t seed,
                                        int frames) const {
  Image<float> picture = readOut(*sensor_, light, seed);
  for (int k = 1; k < frames; ++k) {
    const Image<float> one =
        readOut(*sensor_, light, hashSeed(seed, static_cast<std::uint64_t>(k)));
    for (std::size_t i = 0; i < picture.texels().size(); ++i)
      picture.texels()[i] += one.texels()[i];
  }
  for (std::size_t k = 0; k < picture.texels().size(); ++k)
    picture.texels()[k] /= flat_.texels()[k] * static_cast<float>(frames);
  return picture;
}

Image<float> ShiftedSpecimen::at(double time, PlacePx shift, std::uint64_t seed) const {
  return developed(lightAt(time, shift), seed);
}

Image<float> ShiftedSpecimen::withoutNoise(const std::vector<float>& light) const {
  Image<float> mosaic(size_.width, size_.height, 1);
  mosaic.texels() = light;
  return demosaicLinear(std::as_const(mosaic).view(), RawMosaic{}.cfa);
}

double ShiftedSpecimen::boundPx(const std::vector<float>& light) const {
  const std::vector<float> falloff = lensFalloff(size_, referenceProfile().lens);
  const Image<float> seen = withoutNoise(light);
  const SensorProfile& sensor = referenceProfile().sensor;
  const double step_e = sensor.electronsPerStep(),
               still_e2 = sensor.read_noise * sensor.read_noise + step_e * step_e / 12;
  double xx = 0, xy = 0, yy = 0;
  for (int y = 1; y < size_.height - 1; ++y)
    for (int x = 1; x < size_.width - 1; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * size_.width + x;
      const int c = (x & 1) + (y & 1);
      const double electrons = electronsPerLight() * falloff[k],
                   weight = 0.5 * electrons * electrons / (electrons * light[k] + still_e2);
      const double gx = 0.5 * (seen.at(x + 1, y, c) - seen.at(x - 1, y, c)),
                   gy = 0.5 * (seen.at(x, y + 1, c) - seen.at(x, y - 1, c));
      xx += weight * gx * gx, xy += weight * gx * gy, yy += weight * gy * gy;
    }
  return std::sqrt((xx + yy) / (xx * yy - xy * xy));
}

std::vector<float> ShiftedSpecimen::withCard(std::vector<float> light, PlacePx shift) const {
  constexpr double kCell_px = 16;
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < cardWidthPx(); ++x) {
      const double u = x - shift.x, v = y - shift.y;
      const double column = std::floor(u / kCell_px), row = std::floor(v / kCell_px);
      const auto cell = static_cast<std::uint64_t>(1000 * (row + 100) + column + 100);
      // Not in rank and file, or one row would be taken for the next; the more of them are missing,
      // the coarser the levels at which they still tell something.
      const bool missing = uniform(hashSeed(cell, 3)) < 0.5;
      const double middle_x = column * kCell_px + 7 + 2 * uniform(hashSeed(cell, 1)),
                   middle_y = row * kCell_px + 7 + 2 * uniform(hashSeed(cell, 2));
      const double black =
          missing ? 0 : std::clamp(6.5 - std::hypot(u - middle_x, v - middle_y), 0.0, 1.0);
      light[static_cast<std::size_t>(y) * size_.width + x] = static_cast<float>(0.6 - 0.55 * black);
    }
  return light;
}

Image<std::uint8_t> ShiftedSpecimen::cardMask() const {
  constexpr int kMarginPx = 8;
  Image<std::uint8_t> mask(size_.width, size_.height, 1);
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < cardWidthPx() - kMarginPx; ++x) mask.at(x, y) = 255;
  return mask;
}

namespace {

std::string rigText(const std::string& specimen, SizePx size, bool with_board) {
  std::string rig =
      "name = 'bench'\n[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [60, 40, 500]\n"
      "[twin]\nspecimen = '" +
      specimen + "'\nsize = '" + std::to_string(size.width) + "x" + std::to_string(size.height) +
      "'\n";
  if (!with_board) return rig;
  const double width = makeSpecimen(specimen, 1)->info().width_mm;
  return rig + "[[twin.target]]\nkind = 'charuco'\ncolumns = 5\nrows = 4\nposition_mm = [" +
         std::to_string(0.28 * width) + ", " + std::to_string(0.28 * width) +
         ", 0.5]\nwidth_mm = " + std::to_string(0.3 * width) + "\n";
}

}  // namespace

TwinView::TwinView(const std::string& specimen, SizePx size, std::vector<devices::Fault> faults,
                   bool with_board, std::uint64_t seed)
    : spec_(devices::parseRig(rigText(specimen, size, with_board), "rig.toml")), clock_(UtcTime{}) {
  TwinOptions options;
  options.duration = kRun;
  options.seed = seed;
  options.faults.faults = std::move(faults);
  world_ = std::make_unique<World>(spec_, options, clock_);
  maker_ = std::make_unique<PictureMaker>(*world_, spec_.cameras[0], CameraPose{}, 1);
}

Image<float> TwinView::picture(Nanoseconds at) {
  ShotLight shot;
  shot.begin = at;
  shot.exposure = defaultExposure();
  shot.levels = {1};
  shot.noise_key = hashSeed(9, static_cast<std::uint64_t>(at.count()));
  return demosaic(maker_->expose(shot));
}

SampleGrid TwinView::groundAt(Nanoseconds at) {
  ShotLight shot;
  shot.begin = at;
  shot.levels = {0};
  maker_->light(shot);
  return maker_->grid();
}

SampleGrid TwinView::onSpecimenAt(Nanoseconds at) {
  return onSpecimen(groundAt(at), world_->specimenPoseAt(at), world_->specimen().info().width_mm);
}

RectPx TwinView::patchWithBorder() const {
  const RectPx patch = layout().patch_px;
  const int border = std::max(1, patch.width / 16);
  return {std::max(0, patch.x - border), patch.y - border, patch.width + 2 * border,
          patch.height + 2 * border};
}

RectPx TwinView::board() const {
  const SizePx size = layout().size;
  const auto x = [&](double share) { return static_cast<int>(share * size.width); };
  const auto y = [&](double share) { return static_cast<int>(share * size.height); };
  return {x(0.63), y(0.1), x(0.3), y(0.24)};
}

PlacePx truePlace(const SampleGrid& before, const SampleGrid& after, PlacePx at) {
  const double x_mm = sample(before.x_mm, before.size, at.x, at.y),
               y_mm = sample(before.y_mm, before.size, at.x, at.y);
  PlacePx place = at;
  for (int step = 0; step < 20; ++step) {
    place.x += (x_mm - sample(after.x_mm, after.size, place.x, place.y)) / after.texel_mm;
    place.y -= (y_mm - sample(after.y_mm, after.size, place.x, place.y)) / after.texel_mm;
  }
  return place;
}

}  // namespace patina::calibration
