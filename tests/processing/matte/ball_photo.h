// SPDX-License-Identifier: GPL-3.0-or-later
// A photograph of a ball on a plain ground, with its parts known.
#pragma once

#include <algorithm>
#include <cmath>

#include "processing/image/image.h"
#include "processing/image/random.h"

namespace patina::matte {

struct BallPhoto {
  static constexpr int kWidth = 240, kHeight = 180;
  static constexpr double kX = 130, kY = 80, kRadius = 34;  // pixels

  Image<float> photo{kWidth, kHeight, 3}, ground{kWidth, kHeight, 3};
  Image<float> mask{kWidth, kHeight, 1}, shadow{kWidth, kHeight, 1};

  // `noise`: standard deviation, share of full scale. The ground is green; the lamp's light falls
  // off across it. The ball is white, with a black patch and one of the ground's own hue, darker.
  // Its shadow reaches into the picture's rim.
  explicit BallPhoto(double noise = 0.004) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double u = (x - 100.0) / kWidth, v = (y - 60.0) / kHeight,
                     light = 0.9 - 0.5 * u * u - 0.3 * v * v + 0.1 * u;
        const double off = std::hypot((x - 78) / 60.0, (y - 112) / 24.0);
        shadow.at(x, y) = static_cast<float>(1 - 0.7 * std::clamp((1.15 - off) / 0.3, 0.0, 1.0));
        const double r = std::hypot(x - kX, y - kY),
                     cover = std::clamp(kRadius + 0.5 - r, 0.0, 1.0);
        mask.at(x, y) = static_cast<float>(cover);
        const bool is_black = std::hypot(x - kX + 8, y - kY - 4) < 9,
                   is_bottle_green = std::hypot(x - kX - 17, y - kY + 6) < 6;
        const float green[3] = {0.10f, 0.55f, 0.16f};
        for (int c = 0; c < 3; ++c) {
          const double behind = green[c] * light;
          ground.at(x, y, c) = static_cast<float>(behind);
          const double own = is_black          ? 0.015
                             : is_bottle_green ? 0.15 * green[c]
                                               : 0.8 - 0.3 * (y - kY) / kRadius;
          const double value = cover * own + (1 - cover) * shadow.at(x, y) * behind;
          photo.at(x, y, c) =
              static_cast<float>(std::max(0.0, value + noise * gaussian(hashSeed(3, x, y, c))));
        }
      }
  }
};

}  // namespace patina::matte
