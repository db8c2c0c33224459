// SPDX-License-Identifier: GPL-3.0-or-later
// An object and its shadow, taken off a photograph before a plain or known background (Enrique et
// al. 2005, figure 10). A pixel is  a F + (1 - a) s B:  F the object's colour, a its cover (the
// mask), B the background, s in [0,1] what the shadow leaves of the light.
//
// What has the background's colour, only darker, is shadow; what differs in colour is object: by
// more than `threshold` times the noise that the background itself shows, and by more than what the
// object's own light thrown back on it, or a blue sky in the shadow, changes in it. Black parts
// inside of an object are told from shadow by lying inside. Pure; the same bytes for any number of
// threads.
#pragma once

#include <array>
#include <variant>

#include "processing/image/image.h"

namespace patina::matte {

struct KeyOptions {
  double threshold = 8;         // times the noise, 2 to 1000
  double difference = 0.06;     // at least, share of the background's brightness, 0 to 1
  double speck_share = 5e-4;    // of the picture: smaller pieces and holes are noise, 0 to 0.5
  double shadow_blur_px = 1.5;  // standard deviation, 0 to 100
  void check() const;           // throws ProcessingError(kUsage)
};

// The background is of one colour whose brightness may change smoothly; that is fitted to the rim
// of the picture.
struct PlainColour {
  std::array<float, 3> linear{0, 1, 0};  // its hue counts alone
};

struct Keyed {
  Image<float> object;  // [h][w][3] linear, the object's own colour also at its edge; else black
  Image<float> mask;    // [h][w][1] 0 to 1
  Image<float> shadow;  // [h][w][1] 1 in full light; under the object: from what is about it
  double noise = 0;     // of the background, share of its brightness
  double object_share = 0, shadow_share = 0;  // of the picture; shadow: what lost a tenth or more
};

// Backgrounds of a picture: what the same camera saw without the object, [h][w][3].
using Background = std::variant<PlainColour, ImageView<const float>>;

// Throws ProcessingError: kUsage for pictures of another size or of one channel, kBadData when the
// rim does not show the background, or nothing stands before it. O(pixels).
Keyed keyOut(ImageView<const float> photo, const Background& background,
             const KeyOptions& options = {});

}  // namespace patina::matte
