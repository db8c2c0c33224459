// SPDX-License-Identifier: GPL-3.0-or-later
// From the world at a time to the numbers of a picture, without files.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "devices/camera.h"
#include "devices/twin/image_sensor.h"
#include "devices/twin/optics.h"
#include "devices/twin/twin.h"
#include "devices/twin/world.h"
#include "processing/image/dng_file.h"

namespace patina::devices::twin {

// What one exposure depends on.
struct ShotLight {
  Nanoseconds begin{};  // run time
  Exposure exposure;
  std::vector<double> levels;  // of every lamp
  Celsius temperature;
  std::uint64_t noise_key = 0;
};

// Thread-bound. Keeps what the shots of one step share: for these the specimen stands still to
// 1/65,536 of its process (nine seconds of a week), far below what a sensor resolves.
class PictureMaker {
 public:
  PictureMaker(const World& world, const PictureLayout& layout, std::uint64_t seed);

  const PictureLayout& layout() const { return layout_; }
  const SampleGrid& grid() const { return grid_; }
  const ImageSensor& sensor() const { return sensor_; }
  RawMosaic expose(const ShotLight& shot);

 private:
  struct LampPicture {
    std::unique_ptr<LampField> field;  // absent until the lamp is lit for the first time
    std::vector<float> light;          // at level 1, [h][w], of specimen time `time_key`
  };
  void renderLamps(std::int64_t time_key, const std::vector<double>& levels);
  void shadeRow(const LampField& field, const SurfaceRow& surface, int y, float* light) const;

  const World& world_;
  PictureLayout layout_;
  SampleGrid grid_;
  std::shared_ptr<const PreparedSurface> surface_;
  ImageSensor sensor_;
  std::int64_t time_key_ = -1;
  std::vector<LampPicture> lamps_;
  std::vector<float> card_;  // reflectance of patch and border; below 0: the specimen shows
};

}  // namespace patina::devices::twin
