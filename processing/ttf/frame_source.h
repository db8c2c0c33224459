// SPDX-License-Identifier: GPL-3.0-or-later
// Where a TTF's frames come from: pulled one at a time, already calibrated and registered.
#pragma once

#include <optional>

#include "processing/image/image.h"
#include "processing/image/sha256.h"

namespace patina::ttf {

struct SourceFrame {
  double time_s = 0;    // from t0
  Sha256 source;        // the original's hash
  Image<float> linear;  // [h][w][c]; 1.0 = full scale; may exceed [0,1] a little
};

class FrameSource {  // Thread-bound.
 public:
  virtual ~FrameSource() = default;
  virtual std::int64_t count() const = 0;         // frames that next() will give
  virtual std::optional<SourceFrame> next() = 0;  // in order of time
};

}  // namespace patina::ttf
