// SPDX-License-Identifier: GPL-3.0-or-later
// A pipeline in virtual time: controls take effect some frames later, and trouble comes on order.
#pragma once

#include <memory>
#include <optional>

#include "devices/libcamera/pipeline.h"

namespace patina::testing {

// What the test turns, and what it may look at. It outlives the pipeline.
struct FakeSensor {
  devices::libcamera::OpenCamera camera;
  int depth = 3;                            // frames until controls take effect
  double exposure_error = 0;                // the driver's rounding: applied = asked * (1 + this)
  std::optional<Nanoseconds> exposure_max;  // longer ones are cut to this, and said so
  bool says_exposure = true;
  double digital_gain = 1;
  int damaged_left = 0;  // so many frames, then good ones
  bool sends = true;
  bool plugged = true;
  bool must_forget = false;  // the library believes what was until it is let go of
  std::optional<devices::Errc> open_error;
  Nanoseconds frame_time = std::chrono::milliseconds(50);

  int frames = 0;  // since the sensor was made; each picture's first byte
  int starts = 0, opens = 0, forgets = 0;
  bool streaming = false;
};

std::unique_ptr<devices::libcamera::Pipeline> makeFakePipeline(FakeSensor& sensor,
                                                               devices::Clock& clock);
// RGB of 4x2 pixels with all controls.
FakeSensor smallSensor();

}  // namespace patina::testing
