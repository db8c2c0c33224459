// SPDX-License-Identifier: GPL-3.0-or-later
// Matchers in Patina's own words, so that a failure names the texel or the error.
#pragma once

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/image.h"

namespace patina::testing {

// EXPECT_THAT(camera.configure(e), IsOk());   for a Result<T> of any T.
MATCHER(IsOk, negation ? "is an error" : "is ok") {
  if (arg.has_value()) return true;
  *result_listener << "error: " << arg.error().what;
  return false;
}

// EXPECT_THAT(camera.trigger(r), Fails(Errc::kBusy));
MATCHER_P(Fails, code, "fails with the given code") {
  if (arg.has_value()) {
    *result_listener << "is ok";
    return false;
  }
  *result_listener << "error: " << arg.error().what;
  return arg.error().code == code;
}

template <class T>
ImageView<const T> viewOf(const Image<T>& image) {
  return image.view();
}
template <class T>
ImageView<const T> viewOf(ImageView<T> view) {
  return view;
}

// EXPECT_THAT(got, ImageNear(want, 1e-4));   Image or ImageView on both sides; every texel within
// `tolerance`, NaN never; names the worst texel.
MATCHER_P2(ImageNear, want, tolerance, "is near the image") {
  const auto got = viewOf(arg);
  const auto ref = viewOf(want);
  if (got.width != ref.width || got.height != ref.height || got.channels != ref.channels) {
    *result_listener << got.width << "x" << got.height << "x" << got.channels << " instead of "
                     << ref.width << "x" << ref.height << "x" << ref.channels;
    return false;
  }
  double worst = -1;
  int worst_x = 0, worst_y = 0, worst_c = 0, wrong = 0;
  for (int y = 0; y < got.height; ++y)
    for (int x = 0; x < got.width; ++x)
      for (int c = 0; c < got.channels; ++c) {
        const double apart =
            std::abs(static_cast<double>(got.at(x, y, c)) - static_cast<double>(ref.at(x, y, c)));
        if (!(apart <= tolerance)) ++wrong;
        if (apart > worst || std::isnan(apart)) {
          worst = std::isnan(apart) ? HUGE_VAL : apart;
          worst_x = x, worst_y = y, worst_c = c;
        }
      }
  if (wrong == 0) return true;
  *result_listener << wrong << " values are off by more than " << tolerance << ", the worst at ("
                   << worst_x << ", " << worst_y << ", channel " << worst_c
                   << "): " << static_cast<double>(got.at(worst_x, worst_y, worst_c))
                   << " instead of " << static_cast<double>(ref.at(worst_x, worst_y, worst_c));
  return false;
}

}  // namespace patina::testing
