// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/picture_maker.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"
#include "devices/twin/troubles.h"
#include "devices/twin/view_troubles.h"

namespace patina::devices::twin {

namespace {

constexpr double kTimeSteps = 65'536;

void add(std::vector<float>& light, double level, const std::vector<float>& more, SizePx size) {
  const auto scale = static_cast<float>(level);
  forRowBlocks(size, [&](int y0, int y1) {
    const auto width = static_cast<std::size_t>(size.width);
    for (std::size_t k = y0 * width; k < y1 * width; ++k) light[k] += scale * more[k];
  });
}

}  // namespace

PictureMaker::PictureMaker(const World& world, const CameraSpec& camera, const CameraPose& pose,
                           std::uint64_t seed)
    : world_(world),
      camera_(camera.id),
      pose_(pose),
      layout_(pictureLayout(world.spec(), camera)),
      sensor_(layout_.size, world.profile().sensor, lensFalloff(layout_.size, world.profile().lens),
              seed) {
  place(Nanoseconds{0});
}

void PictureMaker::place(Nanoseconds run_time) {
  const CameraPose pose = bumpedPose(pose_, world_.faults(), camera_, run_time);
  const SpecimenPose specimen = world_.specimenPoseAt(run_time);
  if (!scene_ || scene_->cameraPose() != pose || scene_->specimenPose() != specimen)
    scene_ = std::make_unique<LitScene>(world_, layout_, pose, specimen);
  const std::vector<LightSpec>& lights = world_.spec().lights;
  for (std::size_t i = 0; i < lights.size(); ++i)
    scene_->placeLamp(i, placeAt(world_.lampPlace(i), world_.faults(), lights[i].id, run_time));
}

std::vector<float> PictureMaker::light(const ShotLight& shot) {
  place(shot.begin);
  std::vector<float> light(grid().x_mm.size(), static_cast<float>(world_.profile().room.ambient));
  std::vector<bool> lit;
  for (const double level : shot.levels) lit.push_back(level > 0);
  const Sky sky = world_.skyAt(shot.begin);
  // In the dark nobody sees the specimen.
  if (std::ranges::find(lit, true) == lit.end() && sky.dome <= 0) return light;
  const double time =
      static_cast<double>(std::llround(world_.specimenTimeAt(shot.begin) * kTimeSteps)) /
      kTimeSteps;
  scene_->render(time, lit);
  for (std::size_t i = 0; i < lit.size(); ++i)
    if (lit[i]) add(light, shot.levels[i], scene_->lamp(i), layout_.size);
  if (sky.dome > 0) add(light, sky.dome, scene_->underSky(), layout_.size);
  if (sky.sun > 0) add(light, sky.sun, scene_->under(sky.sun_place), layout_.size);

  TroubledView view;
  view.camera = camera_;
  view.size = layout_.size;
  view.patch_px = patchInPicture(layout_, scene_->cameraPose(), grid().texel_mm);
  view.patch_reflectance = world_.profile().patch.reflectance;
  view.run_time = shot.begin;
  view.process = world_.duration();
  view.white_card = [&] { return whiteCard(shot); };
  troubleView(world_.faults(), view, light);
  return light;
}

std::vector<float> PictureMaker::whiteCard(const ShotLight& shot) const {
  const Sky sky = world_.skyAt(shot.begin);
  std::vector<float> white(grid().x_mm.size(),
                           static_cast<float>(world_.profile().room.ambient + sky.dome));
  for (std::size_t i = 0; i < shot.levels.size(); ++i)
    if (shot.levels[i] > 0)
      add(white, shot.levels[i], scene_->whiteCard(scene_->lampPlace(i)), layout_.size);
  if (sky.sun > 0) add(white, sky.sun, scene_->whiteCard(sky.sun_place), layout_.size);
  return white;
}

RawMosaic PictureMaker::expose(const ShotLight& shot) {
  std::vector<float> seen = light(shot);
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
  forRowBlocks(layout_.size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y)
      sensor_.readRow(y, &seen[grid().index(0, y)], sensor_shot, raw.samples.view().row(y));
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
