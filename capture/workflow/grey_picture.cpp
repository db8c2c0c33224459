// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/grey_picture.h"

#include <utility>

#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/image/warp.h"

namespace patina::workflow {

Image<float> greyPicture(const std::filesystem::path& file) {
  const Picture picture = readPicture(file);
  Image<float> grey(picture.linear.width(), picture.linear.height(), 1);
  const int channels = picture.linear.channels();
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      float sum = 0;
      for (int c = 0; c < channels; ++c) {
        const float v = picture.linear.at(x, y, c);
        sum += picture.format == PictureFormat::kExr ? v : srgbFromLinear(v);
      }
      grey.at(x, y) = sum / static_cast<float>(channels);
    }
  return grey;
}

Image<float> greyPicture(const std::filesystem::path& file, SizePx size) {
  Image<float> grey = greyPicture(file);
  if (grey.size() == size) return grey;
  return resizeArea(std::as_const(grey).view(), size);
}

}  // namespace patina::workflow
