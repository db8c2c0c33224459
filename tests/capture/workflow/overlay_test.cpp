// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/overlay.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"
#include "processing/matte/keying.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

// Left half object, right half in a shadow that leaves a fifth.
matte::Keyed keyed(int width, int height) {
  matte::Keyed out;
  out.object = Image<float>(width, height, 3);
  out.mask = Image<float>(width, height, 1);
  out.shadow = Image<float>(width, height, 1, 0.2f);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width / 2; ++x) {
      out.mask.at(x, y) = 1;
      out.object.at(x, y, 0) = 0.5f;
    }
  return out;
}

class OneGreyFrame : public ttf::FrameSource {
 public:
  std::int64_t count() const override { return 1; }
  std::optional<ttf::SourceFrame> next() override {
    if (given_) return std::nullopt;
    given_ = true;
    return ttf::SourceFrame{7, Sha256{}, Image<float>(20, 10, 1, 0.25f)};
  }

 private:
  bool given_ = false;
};

Sequence greySequence() {
  Sequence out;
  out.frames = 1;
  out.size = {20, 10};
  out.open = [](int) { return std::make_unique<OneGreyFrame>(); };
  return out;
}

TEST(Overlay, ComesBackFromItsFolderWithinAStepOfItsBits) {
  const TempFolder folder = TempFolder::inMemory();
  writeOverlay(keyed(20, 10), folder / "ball");
  const Overlay back = readOverlay(folder / "ball");
  EXPECT_NEAR(back.object.at(3, 3, 0), 0.5, 0.005);
  EXPECT_EQ(back.mask.at(3, 3), 1);
  EXPECT_EQ(back.mask.at(13, 3), 0);
  EXPECT_NEAR(back.shadow.at(13, 3), 0.2, 1e-4);
  EXPECT_THROW(writeOverlay(keyed(20, 10), folder / "ball"), WorkflowError);
}

TEST(Overlay, LiesOverFramesInTheLightTheyAreShownIn) {
  const TempFolder folder = TempFolder::inMemory();
  writeOverlay(keyed(40, 20), folder / "ball");  // twice as large
  const Sequence shown = overlaid(greySequence(), readOverlay(folder / "ball"), 2);
  const auto frame = shown.open(1)->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->time_s, 7);
  ASSERT_EQ(frame->linear.channels(), 3);
  EXPECT_NEAR(2 * frame->linear.at(3, 3, 0), 0.5, 0.005);
  EXPECT_NEAR(frame->linear.at(3, 3, 1), 0, 1e-6);
  EXPECT_NEAR(frame->linear.at(15, 3, 1), 0.05, 1e-4);
}

TEST(Overlay, RefusesAnotherShapeAndPartsThatDiffer) {
  const TempFolder folder = TempFolder::inMemory();
  writeOverlay(keyed(20, 20), folder / "square");
  EXPECT_THROW(overlaid(greySequence(), readOverlay(folder / "square"), 1), WorkflowError);
  const Image<std::uint8_t> small(8, 8, 1);
  writePng(folder / "square" / "mask.png", small.view());
  EXPECT_THROW(readOverlay(folder / "square"), WorkflowError);
  EXPECT_THROW(readOverlay(folder / "none"), Failure);
}

}  // namespace
}  // namespace patina::workflow
