// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_lights.h"

#include <cmath>
#include <optional>

#include "capture/workflow/failure.h"
#include "capture/workflow/lights_file.h"
#include "capture/workflow/near_lights.h"
#include "capture/workflow/view_calibration.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

brdf::Vec3 vec(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// A picture's name or a lamp's id.
bool names(const std::string& name, const std::string& state) {
  return name == state || fs::path(name).stem() == state;
}

// One way to know lamps: those of a file or a calibration.
class Source {
 public:
  virtual ~Source() = default;
  virtual std::optional<RunLight> find(const std::string& state) const = 0;
};

class Directions final : public Source {
 public:
  Directions(std::vector<LightDirection> lights, std::string from, std::string sha256)
      : lights_(std::move(lights)), from_(std::move(from)), sha256_(std::move(sha256)) {}
  void turnBy(const calibration::View& view) {
    for (LightDirection& light : lights_) light.direction = planeFromCamera(view, light.direction);
  }
  std::optional<RunLight> find(const std::string& state) const override {
    for (const LightDirection& known : lights_) {
      if (!names(known.file, state)) continue;
      RunLight light;
      light.light.direction = brdf::normalized(vec(known.direction));
      light.light.strength = 1 / std::max(light.light.direction.z, 1e-3f);
      light.from = from_;
      light.sha256 = sha256_;
      return light;
    }
    return std::nullopt;
  }

 private:
  std::vector<LightDirection> lights_;
  std::string from_, sha256_;
};

// Of level 1 on a flat card in the middle of the frame.
double nominalStrength(const std::array<double, 3>& at, double beam_exponent,
                       const std::array<double, 3>& aim) {
  const double d2 = at[0] * at[0] + at[1] * at[1] + at[2] * at[2], d = std::sqrt(d2);
  double cone = 1;
  if (beam_exponent > 0) {
    const std::array<double, 3> axis{at[0] - aim[0], at[1] - aim[1], at[2] - aim[2]};
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    const double cosine = (at[0] * axis[0] + at[1] * axis[1] + at[2] * axis[2]) / (d * length);
    cone = std::pow(std::max(cosine, 1e-3), beam_exponent);
  }
  return d2 / (at[2] / d * cone);
}

class NearLamps final : public Source {
 public:
  NearLamps(std::vector<PlacedLamp> lamps, const db::CalibrationRow& row,
            const calibration::CalibrationKey& frames, double card_reflectance, std::string from)
      : lamps_(std::move(lamps)), from_(std::move(from)), sha256_(row.sha256) {
    scale_ = 1 / card_reflectance;
    if (row.exposure.count() > 0 && frames.exposure.count() > 0)
      scale_ *= toSeconds(frames.exposure) / toSeconds(row.exposure);
    if (row.iso > 0 && frames.iso > 0) scale_ *= frames.iso / row.iso;
  }
  std::optional<RunLight> find(const std::string& state) const override {
    for (const PlacedLamp& lamp : lamps_) {
      if (!names(lamp.name, state)) continue;
      const calibration::NearLight& known = lamp.light;
      RunLight light;
      light.light.near = true;
      light.light.position_mm = vec(known.position_mm);
      light.light.aim_mm = vec(known.aim_mm);
      light.light.beam_exponent = static_cast<float>(known.beam_exponent);
      light.strength_known = known.strength > 0;
      light.light.strength = static_cast<float>(
          light.strength_known
              ? known.strength * scale_
              : nominalStrength(known.position_mm, known.beam_exponent, known.aim_mm));
      light.from = from_;
      light.sha256 = sha256_;
      return light;
    }
    return std::nullopt;
  }

 private:
  std::vector<PlacedLamp> lamps_;
  std::string from_, sha256_;
  double scale_ = 1;
};

class OfRig final : public Source {
 public:
  explicit OfRig(const RigLamps& lamps) : lamps_(lamps) {}
  std::optional<RunLight> find(const std::string& state) const override {
    const auto lamp = lamps_.find(state);
    if (lamp == lamps_.end()) return std::nullopt;
    RunLight light;
    light.light.near = true;
    light.light.position_mm = vec(lamp->second);
    light.light.strength = static_cast<float>(nominalStrength(lamp->second, 0, {}));
    light.from = "rig file";
    return light;
  }

 private:
  const RigLamps& lamps_;
};

using Sources = std::vector<std::unique_ptr<Source>>;

void addNearLamps(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                  const RunLightsRequest& request, Sources& sources, RunLights& out) {
  const CalibrationChoice choice = chooseCalibration(reader, "near_lights", frames, request.stale);
  if (!choice.left.empty()) out.left.push_back(choice.left);
  if (!choice.row) return;
  NearLightsFile file = readNearLights(fileOfCalibration(reader, *choice.row));
  if (!file.of_plane) {
    out.left.push_back("near_lights " + std::to_string(choice.row->id) +
                       ": its lamps are placed about the camera, not the specimen; run `patina "
                       "calibrate view`, then `patina calibrate near-lights` again");
    return;
  }
  const double reflectance = file.card_reflectance;
  sources.push_back(std::make_unique<NearLamps>(std::move(file.lamps), *choice.row, frames,
                                                reflectance, choice.used.described));
  out.used.push_back(choice.used);
}

void addDirections(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                   const RunLightsRequest& request, Sources& sources, RunLights& out) {
  const CalibrationChoice choice = chooseCalibration(reader, "lights", frames, request.stale);
  if (!choice.left.empty()) out.left.push_back(choice.left);
  if (!choice.row) return;
  auto directions = std::make_unique<Directions>(readLights(fileOfCalibration(reader, *choice.row)),
                                                 choice.used.described, choice.row->sha256);
  if (request.plane) {
    const CalibrationChoice view = chooseCalibration(reader, "view", frames, request.stale);
    if (view.row) directions->turnBy(readView(fileOfCalibration(reader, *view.row)).view);
  }
  sources.push_back(std::move(directions));
  out.used.push_back(choice.used);
}

}  // namespace

RunLights lightsOfRun(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                      const std::vector<std::string>& states, const RunLightsRequest& request) {
  RunLights out;
  Sources sources;
  if (!request.file.empty())
    sources.push_back(std::make_unique<Directions>(readLights(request.file),
                                                   request.file.filename().string(),
                                                   sha256OfFile(request.file).hex()));
  addNearLamps(reader, frames, request, sources, out);
  addDirections(reader, frames, request, sources, out);
  sources.push_back(std::make_unique<OfRig>(request.rig));
  for (const std::string& state : states) {
    std::optional<RunLight> known;
    for (const auto& source : sources)
      if (!known) known = source->find(state);
    if (!known)
      throw WorkflowError(Exit::kBadData,
                          "where lamp " + state +
                              " stands is not known: give --lights FILE.lp, or run `patina "
                              "calibrate near-lights` or `patina calibrate lights` for " +
                              frames.device_id);
    known->state = state;
    out.lights.push_back(std::move(*known));
  }
  return out;
}

brdf::SurfaceLight seenFrom(brdf::SurfaceLight light, double x_mm, double y_mm) {
  const auto x = static_cast<float>(x_mm), y = static_cast<float>(y_mm);
  light.position_mm.x -= x;
  light.position_mm.y -= y;
  light.aim_mm.x -= x;
  light.aim_mm.y -= y;
  return light;
}

}  // namespace patina::workflow
