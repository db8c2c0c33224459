// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/camera_settings.h"

#include <limits>

#include "devices/settings.h"
#include "devices/v4l2/controls.h"

namespace patina::devices::v4l2 {
namespace {

using namespace std::chrono_literals;

class Reading {
 public:
  Reading(const CameraSpec& spec, const std::filesystem::path& rig_file)
      : spec_(spec), settings_(spec.settings, "camera '" + spec.id + "'", rig_file) {}

  CameraSettings all();

 private:
  bool has(const std::string& key) const { return spec_.settings.contains(key); }
  void takeIdentity(CameraSettings& s);
  void takeFormat(CameraSettings& s);
  void takeControls(CameraSettings& s);
  void takeExposures(CameraSettings& s);
  void takeFrames(CameraSettings& s);

  const CameraSpec& spec_;
  Settings settings_;
};

void Reading::takeIdentity(CameraSettings& s) {
  s.who = "v4l2 '" + spec_.id + "'";
  s.identity.serial = spec_.serial;
  s.identity.device = settings_.takeText("device", "");
  const auto begins = [&](const char* with) { return s.identity.device.rfind(with, 0) == 0; };
  if (!s.identity.device.empty() && !begins("/dev/v4l/by-id/") && !begins("/dev/v4l/by-path/") &&
      !begins("/dev/video"))
    settings_.reject("device",
                     "'" + s.identity.device + "' is no link below /dev/v4l/by-id or by-path");
}

void Reading::takeFormat(CameraSettings& s) {
  s.format = formatNamed(settings_.takeChoice("format", formatNames()));
  if (const std::string size = settings_.takeText("size", ""); !size.empty()) {
    try {
      s.size = parseSize(size);
    } catch (const Failure& problem) {
      settings_.reject("size", problem.what());
    }
    if (s.size.width < 1 || s.size.height < 1 || s.size.width > 65'535 || s.size.height > 65'535)
      settings_.reject("size", "'" + size + "' is out of range (1 to 65535 pixels a side)");
  }
  s.frames_per_second = settings_.takeNumber("frames_per_second", 0.001, 10'000, 0);
  const double white = (1 << s.format->bits) - 1;
  s.black_level = settings_.takeNumber("black_level", 0, white - 1, 0);
  const std::string transfer = settings_.takeChoice("transfer", {"driver", "linear", "srgb"});
  s.transfer = transfer == "linear" ? Transfer::kLinear
               : transfer == "srgb" ? Transfer::kSrgb
                                    : Transfer::kDriver;
}

void Reading::takeControls(CameraSettings& s) {
  constexpr int kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr int kMost = std::numeric_limits<std::int32_t>::max();
  for (const NamedControl& control : namedControls()) {
    if (!control.words.empty()) {
      const std::string word = settings_.takeChoice(control.name, control.words);
      if (has(control.name))
        s.controls[control.id] = static_cast<std::int32_t>(
            std::find(control.words.begin(), control.words.end(), word) - control.words.begin());
    } else {
      const int value = settings_.takeInteger(control.name, kLeast, kMost, 0);
      if (has(control.name)) s.controls[control.id] = value;
    }
  }
}

void Reading::takeExposures(CameraSettings& s) {
  s.exposure_min = settings_.takeExposure("exposure_min", 100us);
  s.exposure_max = settings_.takeExposure("exposure_max", 2s);
  s.cycle = settings_.takeExposure("cycle", 1s);
  if (has("fixed_exposure")) {
    s.fixed_exposure = settings_.takeExposure("fixed_exposure", 10ms);
    s.exposure_min = s.exposure_max = *s.fixed_exposure;
  } else {
    settings_.takeExposure("fixed_exposure", 10ms);
  }
  if (s.exposure_min <= 0ns) settings_.reject("exposure_min", "must be above 0");
  if (s.exposure_min > s.exposure_max) settings_.reject("exposure_min", "is above exposure_max");
  if (s.cycle < 1ms || s.cycle > 60s) settings_.reject("cycle", "is out of range (1ms to 60s)");
}

void Reading::takeFrames(CameraSettings& s) {
  s.warm_up_frames = settings_.takeInteger("warm_up_frames", 0, 1000, s.warm_up_frames);
  s.settle_frames = settings_.takeInteger("settle_frames", 0, 1000, s.settle_frames);
  s.pipeline_frames = settings_.takeInteger("pipeline_frames", 0, 20, s.pipeline_frames);
  s.buffers = settings_.takeInteger("buffers", 2, 16, s.buffers);
  s.stream_between = settings_.takeChoice("between", {"stream", "stop"}) == "stream";
}

CameraSettings Reading::all() {
  CameraSettings s;
  takeIdentity(s);
  takeFormat(s);
  takeControls(s);
  takeExposures(s);
  takeFrames(s);
  settings_.finish();
  return s;
}

}  // namespace

CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file) {
  return Reading(spec, rig_file).all();
}

}  // namespace patina::devices::v4l2
