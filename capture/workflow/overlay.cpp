// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/overlay.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "capture/workflow/failure.h"
#include "capture/workflow/grey_picture.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/image/warp.h"
#include "processing/matte/keying.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr double kShapeOff = 0.02;

// A number of 0 to 1 in each pixel, no light: not gamma-encoded.
Image<std::uint8_t> asShown(const Image<float>& numbers) {
  Image<std::uint8_t> out(numbers.width(), numbers.height(), 1);
  std::transform(numbers.texels().begin(), numbers.texels().end(), out.texels().begin(),
                 [](float v) { return static_cast<std::uint8_t>(std::lround(v * 255)); });
  return out;
}

std::string sizeText(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

class OverlaidFrames : public ttf::FrameSource {
 public:
  OverlaidFrames(std::unique_ptr<ttf::FrameSource> frames, std::shared_ptr<const Overlay> overlay,
                 double gain)
      : frames_(std::move(frames)), overlay_(std::move(overlay)), gain_(gain) {}

  std::int64_t count() const override { return frames_->count(); }
  std::optional<ttf::SourceFrame> next() override {
    auto frame = frames_->next();
    if (frame) frame->linear = laidOver(std::as_const(frame->linear).view());
    return frame;
  }

 private:
  Image<float> laidOver(ImageView<const float> frame) const {
    Image<float> out(frame.width, frame.height, 3);
    const auto own = static_cast<float>(1 / gain_);
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const float a = overlay_->mask.at(x, y), lit = (1 - a) * overlay_->shadow.at(x, y);
        for (int c = 0; c < 3; ++c)
          out.at(x, y, c) = a * own * overlay_->object.at(x, y, c) +
                            lit * frame.at(x, y, frame.channels == 3 ? c : 0);
      }
    return out;
  }

  std::unique_ptr<ttf::FrameSource> frames_;
  std::shared_ptr<const Overlay> overlay_;
  double gain_;
};

Image<float> resized(const Image<float>& image, SizePx size) {
  return image.size() == size ? image : resizeArea(image.view(), size);
}

}  // namespace

void writeOverlay(const matte::Keyed& keyed, const fs::path& folder) {
  if (fs::exists(folder))
    throw WorkflowError(Exit::kCannotCreate, folder.string() + " is there already");
  const fs::path temporary = folder.string() + ".tmp" + std::to_string(getpid());
  fs::create_directories(temporary);
  try {
    writePng(temporary / "object.png", encodeSrgb8(keyed.object.view()).view());
    writePng(temporary / "mask.png", asShown(keyed.mask).view());
    writePng(temporary / "shadow.png", asShown(keyed.shadow).view());
    fs::rename(temporary, folder);
  } catch (...) {
    std::error_code none;
    fs::remove_all(temporary, none);
    throw;
  }
}

Overlay readOverlay(const fs::path& folder) {
  Overlay out{readPicture(folder / "object.png").linear, greyPicture(folder / "mask.png"),
              greyPicture(folder / "shadow.png")};
  if (out.object.channels() != 3 || out.mask.size() != out.object.size() ||
      out.shadow.size() != out.object.size())
    throw WorkflowError(Exit::kBadData,
                        folder.string() + ": object.png, mask.png and shadow.png are " +
                            sizeText(out.object.size()) + ", " + sizeText(out.mask.size()) +
                            " and " + sizeText(out.shadow.size()) +
                            "; they must be alike, and the object in colour");
  return out;
}

Sequence overlaid(const Sequence& sequence, const Overlay& overlay, double gain) {
  const SizePx from = overlay.mask.size(), to = sequence.size;
  const double shape =
      static_cast<double>(from.width) * to.height / (static_cast<double>(from.height) * to.width);
  if (std::abs(shape - 1) > kShapeOff)
    throw WorkflowError(Exit::kUsage, "the overlay is " + sizeText(from) + ", the texture " +
                                          sizeText(to) +
                                          ": their shapes must be alike; crop the photograph");
  auto fitted = std::make_shared<const Overlay>(
      Overlay{resized(overlay.object, to), resized(overlay.mask, to), resized(overlay.shadow, to)});
  Sequence out = sequence;
  out.open = [open = sequence.open, fitted, gain](int every) {
    return std::make_unique<OverlaidFrames>(open(every), fitted, gain);
  };
  return out;
}

}  // namespace patina::workflow
