// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_track.h"

#include <algorithm>
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
  if (recent < 1 || recent > 16)
    throw CalibrationError(
        Exit::kUsage, "registration: recent is " + std::to_string(recent) + "; allowed: 1 to 16");
}

DeformationTrack::DeformationTrack(DeformationTrackOptions options) : options_(std::move(options)) {
  options_.check();
}

Image<std::uint8_t> DeformationTrack::maskOf(SizePx size,
                                             const Motion& frame_from_reference) const {
  if (options_.specimen.empty()) return Image<std::uint8_t>(size.width, size.height, 1, 255);
  return maskMoved(options_.specimen.view(), frame_from_reference, size);
}

DeformationTrack::Held DeformationTrack::heldOf(ImageView<const float> frame,
                                                ImageView<const std::uint8_t> usable) const {
  return {preparePicture(frame, usable), colourPicture(frame, usable)};
}

// Laid over the first frame by its own field, it stands beside it.
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
  if (static_cast<int>(held_.size()) > options_.recent) held_.erase(held_.begin() + 1);
  held_.push_back(heldOf(laid.view(), std::as_const(seen).view()));
  ++made_;
}

// Of what was and what is found anew against a picture held on to.
Deformation DeformationTrack::startOf(const PreparedPicture& held, const PreparedPicture& now,
                                      const Deformation& last, Progress& progress) const {
  constexpr double kTwice = 0.5;
  Deformation anew =
      findDeformation(held, now, last.frame_from_reference, options_.field, progress);
  const bool better = 1 - anew.zncc_after < kTwice * (1 - agreementBy(last, held, now));
  return better ? anew : last;
}

Deformation DeformationTrack::add(ImageView<const float> frame, const Motion& frame_from_reference,
                                  Progress& progress) {
  const Image<std::uint8_t> usable = maskOf(frame.size(), frame_from_reference);
  const Held now = heldOf(frame, usable.view());
  if (made_ == 0) {
    held_.push_back(now);
    made_ = 1;
    last_ = findDeformation(now.light, now.light, frame_from_reference, options_.field, progress);
    return last_;
  }
  last_.frame_from_reference = frame_from_reference;
  Deformation found = startOf(held_.back().light, now.light, last_, progress);
  std::vector<const ColourPicture*> references;
  for (const Held& held : held_) references.push_back(&held.colours);
  std::vector<double> agreements = refineDeformation(references, now.colours, found, progress);
  if (held_.size() > 1 && agreements[0] >= options_.renew_zncc) {  // the first fits again
    held_.resize(1);
    found = startOf(held_[0].light, now.light, found, progress);
    agreements = refineDeformation({&held_[0].colours}, now.colours, found, progress);
  }
  found.zncc_after = *std::max_element(agreements.begin(), agreements.end());
  found.largest_px = largestOf(found.beyond_px);
  last_ = found;
  if (found.zncc_after < options_.renew_zncc) renew(frame, found);
  return found;
}

}  // namespace patina::calibration
