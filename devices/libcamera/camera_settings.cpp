// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/camera_settings.h"

#include <map>

#include "devices/config_file.h"
#include "devices/settings.h"

namespace patina::devices::libcamera {
namespace {

using namespace std::chrono_literals;

constexpr double kNotMoved = -1;  // dioptres

}  // namespace

CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file) {
  const std::string device = "camera '" + spec.id + "'";
  const auto reject = [&](const std::string& key, const std::string& problem) {
    throw ConfigError(rig_file, 0, device + ": " + key, problem);
  };
  CameraSettings made;
  made.who = "libcamera '" + spec.id + "'";
  made.camera_id = spec.serial;
  if (spec.serial.empty())
    reject("serial", "is missing; it is libcamera's camera id, which `patina devices` shows");

  static const std::map<std::string, Wish> kWishes{
      {"png", Wish::kPng}, {"jpg", Wish::kJpeg}, {"dng", Wish::kDng}, {"grey", Wish::kGrey}};
  Settings settings(spec.settings, device, rig_file);
  made.wish = kWishes.at(settings.takeChoice("format", {"png", "jpg", "dng", "grey"}));
  made.size = {settings.takeInteger("width_px", 16, 32768, 0),
               settings.takeInteger("height_px", 16, 32768, 0)};
  if ((made.size.width == 0) != (made.size.height == 0))
    reject("settings.width_px", "and height_px come together, or neither for the largest size");
  made.base_iso = Iso{settings.takeNumber("base_iso", 1, 10'000, 100)};
  made.colour_gains = {settings.takeNumber("red_gain", 0.01, 32, 1),
                       settings.takeNumber("blue_gain", 0.01, 32, 1)};
  const double focus = settings.takeNumber("focus_dioptres", 0, 50, kNotMoved);
  if (focus != kNotMoved) made.focus_dioptres = focus;
  made.black_level = settings.takeNumber("black_level", 0, 65535, 0);
  const Nanoseconds fixed = settings.takeExposure("fixed_exposure", 0ns);
  made.exposure_min = settings.takeExposure("exposure_min", 100us);
  made.exposure_max = settings.takeExposure("exposure_max", 10s);
  made.cycle = settings.takeExposure("cycle", 3s);
  made.warm_up_frames = settings.takeInteger("warm_up_frames", 0, 1000, 2);
  settings.finish();

  if (spec.settings.contains("fixed_exposure")) {
    if (fixed <= 0ns) reject("settings.fixed_exposure", "must be longer than 0");
    made.fixed_exposure = made.exposure_min = made.exposure_max = fixed;
  }
  if (made.exposure_min <= 0ns || made.exposure_min > made.exposure_max)
    reject("settings.exposure_min", "must be longer than 0 and at most exposure_max");
  if (made.exposure_max > 30min) reject("settings.exposure_max", "must be at most 30min");
  if (made.cycle <= 0ns) reject("settings.cycle", "must be longer than 0");
  return made;
}

}  // namespace patina::devices::libcamera
