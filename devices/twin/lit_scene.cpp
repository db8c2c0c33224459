// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lit_scene.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/grid_fields.h"
#include "devices/twin/row_loop.h"

namespace patina::devices::twin {

namespace {

constexpr std::size_t kFieldBytesMax = std::size_t{256} << 20;  // of all lamps of a camera
constexpr float kReliefMargin = 0.06f;  // of the picture's width, beyond what is seen

const std::vector<TargetSpec>& targetsOf(const World& world) {
  static const std::vector<TargetSpec> none;
  return world.spec().twin ? world.spec().twin->targets : none;
}

}  // namespace

int patchBorderPx(const RectPx& patch) {
  return std::max(1, std::min(patch.width, patch.height) / 16);
}

RectPx patchInPicture(const PictureLayout& layout, const CameraPose& pose, double mm_per_px) {
  RectPx seen = layout.patch_px;
  seen.x += static_cast<int>(std::lround(-pose.moved_mm.x / mm_per_px));
  seen.y += static_cast<int>(std::lround(pose.moved_mm.y / mm_per_px));
  return seen;
}

std::vector<float> patchCard(const PictureLayout& layout, const PatchProfile& profile,
                             const CameraPose& pose, double mm_per_px) {
  const RectPx p = patchInPicture(layout, pose, mm_per_px);
  const int border = patchBorderPx(p);
  std::vector<float> card(static_cast<std::size_t>(layout.size.width) * layout.size.height, -1);
  const auto fill = [&](int grow, double reflectance) {
    const int y0 = std::max(0, p.y - grow),
              y1 = std::min(layout.size.height, p.y + p.height + grow),
              x0 = std::max(0, p.x - grow), x1 = std::min(layout.size.width, p.x + p.width + grow);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        card[static_cast<std::size_t>(y) * layout.size.width + x] = static_cast<float>(reflectance);
  };
  fill(border, profile.border_reflectance);
  fill(0, profile.reflectance);
  return card;
}

double viewWidthMm(const World& world, const PictureLayout& layout) {
  return layout.view_mm > 0 ? layout.view_mm : world.specimen().info().width_mm;
}

LitScene::LitScene(const World& world, const PictureLayout& layout, const CameraPose& camera,
                   const SpecimenPose& specimen)
    : world_(world),
      layout_(layout),
      camera_(camera),
      specimen_(specimen),
      view_(layout.size, world.profile().lens, camera, viewWidthMm(world, layout)),
      targets_(targetsOf(world), view_),
      card_(patchCard(layout, world.profile().patch, camera, view_.ground().texel_mm)),
      lamps_(world.lampCount()) {
  const double width_mm = world.specimen().info().width_mm;
  for (std::size_t i = 0; i < lamps_.size(); ++i) lamps_[i].place = world.lampPlace(i);
  const std::size_t field_bytes = 32 * grid().x_mm.size();
  keep_fields_ = field_bytes * lamps_.size() <= kFieldBytesMax;
  places_ = onSpecimen(grid(), specimen, width_mm);
  surface_ = world.specimen().prepare(places_);
  if (!world.spec().twin || !world.spec().twin->shadows) return;
  const Bounds seen = boundsOf(grid(), kReliefMargin * static_cast<float>(width_mm));
  relief_.emplace(seen.x0, seen.y0, seen.x1, seen.y1, grid().texel_mm);
  relief_places_ = onSpecimen(relief_->grid(), specimen, width_mm);
  relief_surface_ = world.specimen().prepare(relief_places_);
  relief_reader_.emplace(relief_->grid(), grid());
}

void LitScene::placeLamp(std::size_t i, const LampPlace& place) {
  LampPicture& lamp = lamps_[i];
  if (lamp.place == place) return;
  lamp.place = place;
  lamp.field.reset();
  lamp.fresh = false;
}

void LitScene::age(double time) {
  if (time == time_) return;
  time_ = time;
  for (LampPicture& lamp : lamps_) lamp.fresh = false;
  rows_.resize(static_cast<std::size_t>(layout_.size.height), SurfaceRow(layout_.size.width));
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      SurfaceRow& row = rows_[static_cast<std::size_t>(y)];
      surface_->rowAt(time, y, row);
      poseRow(places_, y, specimen_, world_.specimen().info().width_mm, row);
    }
  });
  if (relief_) relief_->setHeights(reliefHeights(time));
}

std::vector<float> LitScene::reliefHeights(double time) const {
  const SampleGrid& where = relief_->grid();
  std::vector<float> heights(where.x_mm.size());
  forRowBlocks(where.size, [&](int y0, int y1) {
    SurfaceRow row(where.size.width);
    for (int y = y0; y < y1; ++y) {
      relief_surface_->rowAt(time, y, row);
      poseRow(relief_places_, y, specimen_, world_.specimen().info().width_mm, row);
      std::copy_n(row[SurfaceRow::kHeight], row.width(), &heights[where.index(0, y)]);
    }
  });
  return heights;
}

void LitScene::render(double time, const std::vector<bool>& lit) {
  age(time);
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    LampPicture& lamp = lamps_[i];
    if (!lit[i] || lamp.fresh) continue;
    if (!lamp.field) lamp.field = std::make_unique<LampField>(view_, lamp.place, keep_fields_);
    shade(lamp.place, *lamp.field, lamp.light);
    lamp.fresh = true;
  }
}

void LitScene::shade(const LampPlace& place, const LampField& field,
                     std::vector<float>& light) const {
  light.resize(grid().x_mm.size());
  std::vector<float> visibility;
  if (relief_) visibility = relief_->visibility(place);
  const int width = layout_.size.width;
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    std::vector<float> scratch, seen(relief_ ? static_cast<std::size_t>(width) : 0),
        flat(static_cast<std::size_t>(width));
    for (int y = y0; y < y1; ++y) {
      const LampRow lamp = field.row(y, scratch);
      ShadedRow row{rows_[static_cast<std::size_t>(y)], lamp, view_.viewRow(y),
                    world_.specimen().measured()};
      if (relief_) {
        relief_reader_->readRow(visibility, y, seen.data());
        row.visibility = seen.data();
      }
      float* out = &light[grid().index(0, y)];
      shadeMosaicRow(row, y, out);
      const float* card = &card_[grid().index(0, y)];
      if (*std::max_element(card, card + width) < 0) continue;
      shadeCardRow(lamp, width, flat.data());
      for (int x = 0; x < width; ++x)
        if (card[x] >= 0) out[x] = card[x] * flat[x];
    }
  });
  targets_.draw(place, light);
}

std::vector<float> LitScene::under(const LampPlace& place) const {
  std::vector<float> light;
  shade(place, LampField(view_, place, false), light);
  return light;
}

std::vector<float> LitScene::underSky() const {
  std::vector<float> light(grid().x_mm.size());
  const int width = layout_.size.width;
  for (int y = 0; y < layout_.size.height; ++y) {
    float* out = &light[grid().index(0, y)];
    addSkyMosaicRow(rows_[static_cast<std::size_t>(y)], y, 1, out);
    const float* card = &card_[grid().index(0, y)];
    for (int x = 0; x < width; ++x)
      if (card[x] >= 0) out[x] = card[x];
  }
  targets_.drawSky(1, light);
  return light;
}

std::vector<float> LitScene::whiteCard(const LampPlace& place) const {
  std::vector<float> light(grid().x_mm.size());
  const LampField field(view_, place, false);
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    std::vector<float> scratch;
    for (int y = y0; y < y1; ++y)
      shadeCardRow(field.row(y, scratch), layout_.size.width, &light[grid().index(0, y)]);
  });
  return light;
}

}  // namespace patina::devices::twin
