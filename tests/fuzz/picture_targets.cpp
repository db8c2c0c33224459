// SPDX-License-Identifier: GPL-3.0-or-later
// What looks at pictures before anybody decodes them.
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

}  // namespace patina::testing
