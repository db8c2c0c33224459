// SPDX-License-Identifier: GPL-3.0-or-later
// How a lens was set, as picture files say: geometry and fall-off are of one zoom and focus.
#pragma once

#include <span>
#include <string>

#include "capture/workflow/facts.h"

namespace patina::workflow {

struct Zoom {
  double focal_mm = 0, focus_m = 0;  // 0: the file does not say
};
Zoom zoomOf(std::span<const std::byte> picture_file);

// Of pictures that are to serve one calibration, each added by its name. Throws
// WorkflowError(kBadData) where two of them are set apart (1 % of the focal length, 5 % of the
// focus).
class CommonZoom {
 public:
  void add(const Zoom& zoom, const std::string& name);
  const Zoom& zoom() const { return zoom_; }

 private:
  Zoom zoom_;
  std::string focal_of_, focus_of_;  // which picture said so first
};

void addZoom(Facts& values, const Zoom& zoom);  // what is known of "focal_mm", "focus_m"

}  // namespace patina::workflow
