// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_track.h"

#include <string>
#include <utility>

#include "calibration/failure.h"
#include "calibration/registration/registration.h"

namespace patina::calibration {

void DeformationTrackOptions::check() const {
  field.check();
  if (!(renew_zncc >= 0 && renew_zncc <= 1))
    throw CalibrationError(Exit::kUsage, "registration: renew_zncc is " +
                                             std::to_string(renew_zncc) + "; allowed: 0 to 1");
}

DeformationTrack::DeformationTrack(DeformationTrackOptions options) : options_(std::move(options)) {
  options_.check();
}

PreparedPicture DeformationTrack::prepared(ImageView<const float> frame,
                                           const Motion& frame_from_reference) const {
  if (options_.specimen.empty()) return preparePicture(frame);
  const Image<std::uint8_t> mask =
      maskMoved(options_.specimen.view(), frame_from_reference, frame.size());
  return preparePicture(frame, mask.view());
}

bool DeformationTrack::hasAged(const Deformation& found) const {
  return found.zncc_after < options_.renew_zncc;
}

// Laid over the first frame by its own field, it stands in for it.
void DeformationTrack::renew(ImageView<const float> frame, const Deformation& found) {
  const PixelMap map = found.map();
  const SizePx size = map.size();
  Image<std::uint8_t> seen(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float u = map.source_px.at(x, y, 0), v = map.source_px.at(x, y, 1);
      const bool inside = u >= 0 && v >= 0 && u <= static_cast<float>(frame.width - 1) &&
                          v <= static_cast<float>(frame.height - 1);
      const bool specimen = options_.specimen.empty() || options_.specimen.at(x, y) != 0;
      seen.at(x, y) = inside && specimen ? 255 : 0;
    }
  const Image<float> laid = resample(frame, map);
  recent_ = preparePicture(laid.view(), std::as_const(seen).view());
  ++made_;
}

Deformation DeformationTrack::add(ImageView<const float> frame, const Motion& frame_from_reference,
                                  Progress& progress) {
  const PreparedPicture now = prepared(frame, frame_from_reference);
  if (made_ == 0) {
    first_ = now;
    made_ = 1;
  }
  const bool held_first = recent_.levels.empty();
  Deformation found = findDeformation(held_first ? first_ : recent_, now, frame_from_reference,
                                      options_.field, progress);
  if (!hasAged(found)) return found;
  if (!held_first) {
    Deformation by_first =
        findDeformation(first_, now, frame_from_reference, options_.field, progress);
    if (!hasAged(by_first)) {
      recent_ = {};
      return by_first;
    }
  }
  renew(frame, found);
  return found;
}

}  // namespace patina::calibration
