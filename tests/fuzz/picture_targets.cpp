// SPDX-License-Identifier: GPL-3.0-or-later
// What looks at pictures before anybody decodes them, and what decodes them.
#include <cstdlib>

#include "processing/image/dng_file.h"
#include "processing/image/failure.h"
#include "processing/image/picture_file.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {

void fuzzPictureHeader(std::span<const std::byte> bytes) {
  extensionOf(sniffFormat(bytes));
  try {
    readPictureHeader(bytes);
  } catch (const ProcessingError&) {
    // No picture, cut short, or beyond the limits.
  }
}

// Small ones: a fuzzer's time goes into bytes, not into texels.
void fuzzPictureSamples(std::span<const std::byte> bytes) {
  PictureLimits limits;
  limits.pixels_max = 256 * 256;
  try {
    const PictureFormat format = sniffFormat(bytes);
    const SizePx size = readPictureHeader(bytes, limits).size;
    if (format == PictureFormat::kDng || format == PictureFormat::kRaw)
      decodeRaw(bytes, limits);
    else if (!(decodePicture(bytes, limits).linear.size() == size))
      std::abort();  // the header promised another one
  } catch (const ProcessingError&) {
  }
}

}  // namespace patina::testing
