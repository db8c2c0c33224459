// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/image.h"

namespace patina::devices::twin {

inline double meanOf(const Image<float>& image, int channel = 0) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.at(x, y, channel);
  return sum / (static_cast<double>(image.width()) * image.height());
}

}  // namespace patina::devices::twin
