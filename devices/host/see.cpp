// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/see.h"

#include <new>

#include "processing/image/thumbnail.h"

namespace patina::devices::host {

Seen see(std::span<const std::byte> file) {
  Seen seen;
  try {
    const Picture picture = decodePicture(file);
    seen.size = picture.linear.size();
    seen.bits = picture.bits;
    seen.thumbnail = thumbnailJpeg(picture, kThumbnailPx);
  } catch (const ProcessingError& error) {
    seen.refused = error.what();
  } catch (const std::bad_alloc&) {
    seen.refused = "the picture takes more memory than its driver's process may have";
  } catch (const std::exception& error) {
    seen.refused = std::string("its decoder threw: ") + error.what();
  }
  return seen;
}

}  // namespace patina::devices::host
