// SPDX-License-Identifier: GPL-3.0-or-later
// Is this the frame that was asked for? Controls travel through a pipeline and take effect some
// frames later; each frame says what it was taken with. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "processing/image/units.h"

namespace patina::devices::libcamera {

// Nothing: the camera has no such control, or does not say.
struct Controls {
  std::optional<Nanoseconds> exposure;
  std::optional<double> analogue_gain;
  std::optional<std::array<double, 2>> colour_gains;  // red, blue
  std::optional<double> focus_dioptres;
  bool operator==(const Controls&) const = default;
};

struct Metadata {
  Controls applied;
  std::optional<double> digital_gain;  // must be 1: it is no light, only a factor
  std::optional<Nanoseconds> stamp;    // CLOCK_MONOTONIC, when the readout began
  std::uint32_t sequence = 0;
};

struct Verdict {
  enum Kind { kTaken, kDiffers, kUnsaid };
  Kind kind = kTaken;
  std::string why;  // "exposure: asked 0.01 s, got 0.0333 s"
};

// Within 1 % each, focus within 0.05 dioptres at least. Exposure and gain must be said, the rest is
// held against what is.
Verdict judge(const Controls& asked, const Metadata& frame);

}  // namespace patina::devices::libcamera
