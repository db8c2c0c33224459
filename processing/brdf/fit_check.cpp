// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_check.h"

#include <cmath>
#include <string>

namespace patina::brdf {
namespace {

constexpr double kUnitOff = 1e-3;     // of a direction's length
constexpr double kPlaneShare = 1e-4;  // of the lights' moments that lies off their common plane

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kBadData, what); }

void checkLight(const SurfaceLight& light, std::size_t i) {
  const std::string name = "light " + std::to_string(i + 1);
  const Vec3& d = light.near ? light.position_mm : light.direction;
  if (!std::isfinite(d.x) || !std::isfinite(d.y) || !std::isfinite(d.z) || !(length(d) > 0))
    refuse(name + " has no direction");
  if (!light.near && !(std::abs(length(d) - 1) < kUnitOff))
    refuse(name + " has a direction of length " + std::to_string(length(d)) + " instead of 1");
  if (!(light.strength > 0) || !std::isfinite(light.strength))
    refuse(name + " has a strength of " + std::to_string(light.strength) + "; it is above 0");
}

// det of the matrix of second moments of the directions, whose trace is 1.
void checkSpan(const std::vector<FitSample>& samples) {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  const auto n = static_cast<double>(samples.size());
  for (const FitSample& sample : samples) {
    const Vec3 l =
        sample.light.near ? normalized(sample.light.position_mm) : sample.light.direction;
    xx += l.x * l.x / n, xy += l.x * l.y / n, xz += l.x * l.z / n;
    yy += l.y * l.y / n, yz += l.y * l.z / n, zz += l.z * l.z / n;
  }
  const double det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  if (!(det > kPlaneShare / 27))
    refuse(
        "all lights lie in one plane with the middle of the surface: normals cannot be told "
        "from them; put lights on both sides of that plane");
}

void checkBefore(const FitBefore& before, SizePx size) {
  for (const auto& map : {before.specular, before.roughness, before.confidence})
    if (map.size() != size) refuse("the fit of another time step has another size");
}

}  // namespace

void MultiLightOptions::check() const {
  const auto need = [](bool good, const char* what) {
    if (!good) throw ProcessingError(Exit::kUsage, what);
  };
  need(noise.floor > 0 && noise.shot >= 0 && noise.gain >= 0,
       "noise: the floor is above 0, shot and gain are not below 0");
  need(saturated > 0, "saturated is above 0");
  need(mm_per_texel > 0, "mm_per_texel is above 0");
  need(rounds >= 1 && rounds <= 10, "rounds lies between 1 and 10");
  need(steps >= 1 && steps <= 50, "steps lies between 1 and 50");
  need(neighbour_px >= 1 && neighbour_px <= 256, "neighbour_px lies between 1 and 256");
  need(like_colour > 0, "like_colour is above 0");
  need(specular_spread > 0 && specular_spread <= 1, "specular_spread lies above 0, up to 1");
}

void checkSamples(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                  const std::vector<FitBefore>& before) {
  const std::size_t fewest = options.model == Model::kLambert ? 3 : 6;
  if (samples.size() < fewest)
    refuse(std::to_string(samples.size()) + (samples.size() == 1 ? " light does" : " lights do") +
           " not tell reflectance: at least " + std::to_string(fewest) + " are needed for the " +
           nameOf(options.model) + " model" +
           (options.model == Model::kLambert ? "" : " (3 for lambert)"));
  const ImageView<const float>& first = samples[0].picture;
  int behind = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const FitSample& sample = samples[i];
    if (sample.picture.empty() || sample.picture.size() != first.size())
      refuse("picture " + std::to_string(i + 1) + " is " + std::to_string(sample.picture.width) +
             "x" + std::to_string(sample.picture.height) + ", the first " +
             std::to_string(first.width) + "x" + std::to_string(first.height));
    if (sample.picture.channels != first.channels || (first.channels != 1 && first.channels != 3))
      refuse("picture " + std::to_string(i + 1) + " has " +
             std::to_string(sample.picture.channels) + " channels; all have 1 or all 3");
    checkLight(sample.light, i);
    behind += (sample.light.near ? sample.light.position_mm.z : sample.light.direction.z) <= 0;
    if (!(sample.view.z > 0) || !(std::abs(length(sample.view) - 1) < kUnitOff))
      refuse("view " + std::to_string(i + 1) + " is no unit direction from above the surface");
  }
  if (behind == static_cast<int>(samples.size()))
    refuse("all lights lie behind the surface (z <= 0): z points to the camera; turn its sign");
  if (behind > 0)
    refuse(std::to_string(behind) + " of " + std::to_string(samples.size()) +
           " lights lie behind the surface (z <= 0): leave their pictures out");
  checkSpan(samples);
  for (const FitBefore& other : before) checkBefore(other, first.size());
}

}  // namespace patina::brdf
