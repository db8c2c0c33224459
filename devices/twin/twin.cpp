// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/twin.h"

#include <algorithm>

#include "devices/config_file.h"
#include "devices/settings.h"
#include "devices/twin/lit_scene.h"
#include "devices/twin/twin_devices.h"

namespace patina::devices::twin {

namespace {

void requireTwin(const RigSpec& spec, const std::string& device, const std::string& backend) {
  if (backend != "twin")
    throw ConfigError(spec.source, 0, device + ": backend",
                      "'" + backend + "' is not 'twin': a twin rig has no real devices");
}

RectPx largestBeside(SizePx size, const RectPx& hole) {
  const int right = hole.x + hole.width, bottom = hole.y + hole.height;
  const RectPx sides[] = {{0, 0, size.width, hole.y},
                          {right, 0, size.width - right, size.height},
                          {0, 0, hole.x, size.height},
                          {0, bottom, size.width, size.height - bottom}};
  return *std::max_element(
      std::begin(sides), std::end(sides), [](const RectPx& a, const RectPx& b) {
        return static_cast<long>(a.width) * a.height < static_cast<long>(b.width) * b.height;
      });
}

}  // namespace

Rig makeTwinRig(const RigSpec& spec, const TwinOptions& options, Clock& clock) {
  for (const auto& d : spec.cameras) requireTwin(spec, "camera '" + d.id + "'", d.backend);
  for (const auto& d : spec.lights) requireTwin(spec, "light '" + d.id + "'", d.backend);
  for (const auto& d : spec.sensors) requireTwin(spec, "sensor '" + d.id + "'", d.backend);
  for (const auto& d : spec.triggers) requireTwin(spec, "trigger '" + d.id + "'", d.backend);

  const auto world = std::make_shared<World>(spec, options, clock);
  Rig rig;
  rig.spec = spec;
  // The twin draws a patch in every picture: where the rig file is silent, the rig says where.
  for (const auto& d : spec.cameras)
    if (std::none_of(spec.patches.begin(), spec.patches.end(),
                     [&](const PatchSpec& patch) { return patch.camera == d.id; }))
      rig.spec.patches.push_back({d.id, pictureLayout(spec, d).patch_px});
  for (const auto& d : spec.cameras) rig.cameras.push_back(makeTwinCamera(world, d));
  for (std::size_t i = 0; i < spec.lights.size(); ++i)
    rig.lights.push_back(makeTwinLight(world, i));
  for (const auto& d : spec.sensors) rig.sensors.push_back(makeTwinSensor(world, d));
  for (const auto& d : spec.triggers) rig.triggers.push_back(makeTwinTrigger(world, d));
  return rig;
}

PictureLayout pictureLayout(const RigSpec& spec, const CameraSpec& camera) {
  Settings settings(camera.settings, "camera '" + camera.id + "'", spec.source);
  const SizePx usual = spec.twin ? spec.twin->size : TwinSpec{}.size;
  PictureLayout layout;
  layout.size = {settings.takeInteger("width", 16, 16'384, usual.width),
                 settings.takeInteger("height", 16, 16'384, usual.height)};
  layout.view_mm = settings.takeNumber("view_mm", 0.1, 1e4, 0);
  if (layout.view_mm > 0 && camera.settings.contains("position_mm"))
    settings.reject("view_mm", "a pinhole sees what its position and focal length say");
  if (layout.size.width % 2 != 0 || layout.size.height % 2 != 0)
    throw ConfigError(spec.source, 0, "camera '" + camera.id + "': size",
                      "width and height must be even: the mosaic has cells of 2x2");

  const PatchProfile& profile = referenceProfile().patch;
  const int side = layout.size.height < profile.small_below_px
                       ? layout.size.height / profile.small_divisor
                       : profile.side_px;
  const int margin = patchBorderPx({0, 0, side, side});
  layout.patch_px = {margin, layout.size.height - margin - side, side, side};
  for (const PatchSpec& patch : spec.patches)
    if (patch.camera == camera.id) layout.patch_px = patch.rect_px;
  const RectPx& p = layout.patch_px;
  if (p.x < 0 || p.y < 0 || p.width < 1 || p.height < 1 || p.x + p.width > layout.size.width ||
      p.y + p.height > layout.size.height)
    throw ConfigError(spec.source, 0, "patch.rect_px",
                      "lies outside the picture of camera '" + camera.id + "' (" +
                          std::to_string(layout.size.width) + "x" +
                          std::to_string(layout.size.height) + ")");
  const int border = patchBorderPx(p);
  const int x0 = std::max(0, p.x - border), y0 = std::max(0, p.y - border);
  layout.specimen_px =
      largestBeside(layout.size, {x0, y0, std::min(layout.size.width, p.x + p.width + border) - x0,
                                  std::min(layout.size.height, p.y + p.height + border) - y0});
  return layout;
}

Exposure defaultExposure() {
  const Profile& profile = referenceProfile();
  Exposure exposure;
  exposure.time = fromSeconds(profile.exposure.mains_half_periods / (2 * profile.lamp.mains_hz));
  return exposure;
}

}  // namespace patina::devices::twin
