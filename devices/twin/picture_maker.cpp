// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/picture_maker.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"

namespace patina::devices::twin {

namespace {

constexpr double kTimeSteps = 65'536;

std::vector<float> cardMap(const PictureLayout& layout, const PatchProfile& profile) {
  const RectPx& p = layout.patch_px;
  const int border = patchBorderPx(p);
  std::vector<float> card(static_cast<std::size_t>(layout.size.width) * layout.size.height, -1);
  const auto fill = [&](int grow, double reflectance) {
    for (int y = std::max(0, p.y - grow); y < std::min(layout.size.height, p.y + p.height + grow);
         ++y)
      for (int x = std::max(0, p.x - grow); x < std::min(layout.size.width, p.x + p.width + grow);
           ++x)
        card[static_cast<std::size_t>(y) * layout.size.width + x] = static_cast<float>(reflectance);
  };
  fill(border, profile.border_reflectance);
  fill(0, profile.reflectance);
  return card;
}

}  // namespace

PictureMaker::PictureMaker(const World& world, const PictureLayout& layout, std::uint64_t seed)
    : world_(world),
      layout_(layout),
      grid_(lensGrid(layout.size, world.profile().lens, world.specimen().info().width_mm)),
      surface_(world.specimen().prepare(grid_)),
      sensor_(layout.size, world.profile().sensor, lensFalloff(layout.size, world.profile().lens),
              seed),
      lamps_(world.lampCount()),
      card_(cardMap(layout, world.profile().patch)) {}

void PictureMaker::shadeRow(const LampField& field, const SurfaceRow& surface, int y,
                            float* light) const {
  const int width = layout_.size.width;
  shadeMosaicRow(surface, field, y, light);
  const int border = patchBorderPx(layout_.patch_px);
  if (y < layout_.patch_px.y - border || y >= layout_.patch_px.y + layout_.patch_px.height + border)
    return;
  const float* card = &card_[static_cast<std::size_t>(y) * width];
  std::vector<float> flat(static_cast<std::size_t>(width));
  shadeCardRow(field, y, width, flat.data());
  for (int x = 0; x < width; ++x)
    if (card[x] >= 0) light[x] = card[x] * flat[x];
}

void PictureMaker::renderLamps(std::int64_t time_key, const std::vector<double>& levels) {
  bool fresh = time_key == time_key_;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    if (levels[i] <= 0 || lamps_[i].field) continue;
    lamps_[i].field =
        std::make_unique<LampField>(lampField(grid_, world_.spec().lights[i].position_mm));
    lamps_[i].light.resize(grid_.x_mm.size());
    fresh = false;
  }
  if (fresh) return;
  const bool any = std::any_of(levels.begin(), levels.end(), [](double l) { return l > 0; });
  if (!any) return;  // in the dark nobody sees the specimen
  const double time = static_cast<double>(time_key) / kTimeSteps;
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    SurfaceRow row(layout_.size.width);
    for (int y = y0; y < y1; ++y) {
      surface_->rowAt(time, y, row);
      for (LampPicture& lamp : lamps_)
        if (lamp.field) shadeRow(*lamp.field, row, y, &lamp.light[grid_.index(0, y)]);
    }
  });
  time_key_ = time_key;
}

RawMosaic PictureMaker::expose(const ShotLight& shot) {
  renderLamps(std::llround(world_.specimenTimeAt(shot.begin) * kTimeSteps), shot.levels);
  const SensorProfile& profile = world_.profile().sensor;
  const double stop = 8 / shot.exposure.f_number.value;
  SensorShot sensor_shot;
  sensor_shot.electrons_per_light = static_cast<float>(
      profile.full_well * profile.grey_fill / profile.grey_reflectance *
      toSeconds(shot.exposure.time) / toSeconds(profile.grey_exposure) * stop * stop);
  sensor_shot.exposure = shot.exposure.time;
  sensor_shot.iso = shot.exposure.iso;
  sensor_shot.temperature = shot.temperature;
  sensor_shot.noise_key = shot.noise_key;

  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(layout_.size.width, layout_.size.height, 1);
  const auto ambient = static_cast<float>(world_.profile().room.ambient);
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    std::vector<float> light(static_cast<std::size_t>(layout_.size.width));
    for (int y = y0; y < y1; ++y) {
      std::fill(light.begin(), light.end(), ambient);
      for (std::size_t i = 0; i < lamps_.size(); ++i) {
        if (shot.levels[i] <= 0) continue;
        const auto level = static_cast<float>(shot.levels[i]);
        const float* lamp = &lamps_[i].light[grid_.index(0, y)];
        for (int x = 0; x < layout_.size.width; ++x) light[x] += level * lamp[x];
      }
      sensor_.readRow(y, light.data(), sensor_shot, raw.samples.view().row(y));
    }
  });
  raw.black_level = profile.black_level;
  raw.white_level = profile.whiteLevel();
  raw.exposure = shot.exposure.time;
  raw.iso = shot.exposure.iso;
  raw.f_number = shot.exposure.f_number;
  raw.make = "Patina";
  raw.model = "Twin";
  return raw;
}

}  // namespace patina::devices::twin
