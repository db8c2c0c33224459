// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/reduced_grey.h"

#include <algorithm>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {

Image<float> reducedGrey(ImageView<const float> picture, int by) {
  PATINA_CHECK(by >= 1);
  Image<float> small(picture.width / by, picture.height / by, 1);
  const int count = by * picture.channels;
  forEachRow(small.height(), std::int64_t{picture.width} * by * picture.channels, [&](int y) {
    for (int x = 0; x < small.width(); ++x) {
      double sum = 0;
      for (int v = 0; v < by; ++v) {
        const float* texels = picture.row(y * by + v) + static_cast<std::ptrdiff_t>(x) * count;
        for (int k = 0; k < count; ++k) sum += texels[k];
      }
      small.at(x, y) = static_cast<float>(sum / (static_cast<double>(by) * count));
    }
  });
  return small;
}

int reductionTo(int side_px, SizePx of) {
  return std::max(1, (std::max(of.width, of.height) + side_px - 1) / side_px);
}

}  // namespace patina::calibration
