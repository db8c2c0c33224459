// SPDX-License-Identifier: GPL-3.0-or-later
// /dev and /sys with simulated cameras, for this process only. It must run under umockdev-wrapper;
// one testbed at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/v4l2/simulated_camera.h"

namespace patina::testing {

// Declares a test as one for umockdev-wrapper, which CTest starts it with.
bool underUmockdev();

class V4l2Testbed {
 public:
  V4l2Testbed();
  ~V4l2Testbed();
  V4l2Testbed(const V4l2Testbed&) = delete;
  V4l2Testbed& operator=(const V4l2Testbed&) = delete;

  // As /dev/video<number> on a USB port of its own; the camera outlives the testbed. A camera with
  // a serial has a link below /dev/v4l/by-id, all have one in by-path.
  void plugIn(SimulatedCamera& camera, int number, int port);
  void pullOut(SimulatedCamera& camera);
  static std::string byId(const SimulatedCamera& camera);
  static std::string byPath(int port);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina::testing
