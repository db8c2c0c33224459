// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/thumbnail.h"

#include "processing/image/encoding.h"
#include "processing/image/warp.h"

namespace patina {

Bytes thumbnailJpeg(const Picture& picture, int side_px) {
  constexpr int kQuality = 82;
  SizePx size = fitInside(picture.linear.size(), {side_px, side_px});
  if (size.width > picture.linear.width()) size = picture.linear.size();
  return encodeJpeg(encodeSrgb8(resizeArea(picture.linear.view(), size).view()).view(), kQuality);
}

}  // namespace patina
