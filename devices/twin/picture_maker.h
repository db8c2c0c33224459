// SPDX-License-Identifier: GPL-3.0-or-later
// From the world at a time to the numbers of a picture, without files.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "devices/camera.h"
#include "devices/twin/image_sensor.h"
#include "devices/twin/lit_scene.h"
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
  // Throws ProcessingError(kConfig) for a pose that sees beyond the specimen's plane.
  PictureMaker(const World& world, const CameraSpec& camera, const CameraPose& pose,
               std::uint64_t seed);

  const PictureLayout& layout() const { return layout_; }
  const SampleGrid& grid() const { return scene_->grid(); }
  const ImageSensor& sensor() const { return sensor_; }
  // What a camera without noise, grain and fall-off would see, [h][w]: reflected light of each
  // pixel's channel in units of a white diffuser under one lamp in the middle of the specimen.
  std::vector<float> light(const ShotLight& shot);
  RawMosaic expose(const ShotLight& shot);

 private:
  void place(Nanoseconds run_time);
  std::vector<float> whiteCard(const ShotLight& shot) const;

  const World& world_;
  std::string camera_;
  CameraPose pose_;
  PictureLayout layout_;
  std::unique_ptr<LitScene> scene_;  // of the poses at the last shot
  ImageSensor sensor_;
};

}  // namespace patina::devices::twin
