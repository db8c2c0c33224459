// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the twin whose motion is known, for tests of registration.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calibration/registration/motion.h"
#include "devices/fault_plan.h"
#include "devices/twin/picture_maker.h"
#include "processing/image/image.h"

namespace patina::calibration {

// A specimen from straight above without a lens, moved by a known shift: what the picture of no
// shift shows at (x, y) this one shows at (x + shift.x, y + shift.y). Each pixel sees the mean over
// its area; through sensor and mosaic, demosaiced, flat-corrected; each `seed` has noise of its
// own.
class ShiftedSpecimen {
 public:
  // `points`: of a pixel's area, across; where the surface has edges of half a pixel, 2 are too
  // few.
  ShiftedSpecimen(const std::string& name, SizePx size, int points = 2);
  Image<float> at(double time, PlacePx shift, std::uint64_t seed) const;
  // Cramer and Rao's bound of a shift between two such pictures, sqrt(x^2 + y^2): Fisher's matrix
  // of what the mosaic's pixels would see without noise, each by its colour's interpolated
  // gradient, under the profile's noise of both.
  double boundPx(const std::vector<float>& light) const;

  // In two steps: what reaches the sensor, [h][w], and what it makes of it, as the mean of frames.
  std::vector<float> lightAt(double time, PlacePx shift) const;
  Image<float> developed(const std::vector<float>& light, std::uint64_t seed, int frames = 1) const;
  Image<float> withoutNoise(const std::vector<float>& light) const;  // nor the lens's fall-off
  // The same light where a card of black dots, moved along, lies over the left quarter.
  std::vector<float> withCard(std::vector<float> light, PlacePx shift) const;
  Image<std::uint8_t> cardMask() const;  // well within the card wherever it is moved to by 4 px

 private:
  int cardWidthPx() const { return size_.width / 4; }

  std::unique_ptr<devices::twin::Specimen> specimen_;
  SizePx size_;
  int points_;
  std::unique_ptr<devices::twin::ImageSensor> sensor_;
  Image<float> flat_;  // of 16 pictures of a white card
};

// A camera of the twin, its grey patch in the lower left corner, on a run of 100 h with faults. The
// board is a ChArUco in the upper right, three tenths of the picture wide. `seed`: of the specimen.
class TwinView {
 public:
  TwinView(const std::string& specimen, SizePx size, std::vector<devices::Fault> faults = {},
           bool with_board = false, std::uint64_t seed = 1);
  TwinView(const TwinView&) = delete;
  TwinView& operator=(const TwinView&) = delete;

  Image<float> picture(Nanoseconds at);  // demosaiced, linear
  // Where each pixel meets the specimen, in mm of its own: the truth of every motion.
  devices::twin::SampleGrid onSpecimenAt(Nanoseconds at);
  devices::twin::SampleGrid groundAt(Nanoseconds at);
  const devices::twin::PictureLayout& layout() const { return maker_->layout(); }
  RectPx patchWithBorder() const;
  RectPx board() const;  // well within it

 private:
  devices::RigSpec spec_;
  devices::VirtualClock clock_;
  std::unique_ptr<devices::twin::World> world_;
  std::unique_ptr<devices::twin::PictureMaker> maker_;
};

// Where the frame of grid `after` shows what the frame of `before` shows at `at`. NaN outside.
PlacePx truePlace(const devices::twin::SampleGrid& before, const devices::twin::SampleGrid& after,
                  PlacePx at);

}  // namespace patina::calibration
