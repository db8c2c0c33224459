// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/preview.h"

#include <gtest/gtest.h>

#include "processing/image/thumbnail.h"
#include "tests/capture/app/daemon/bench.h"

namespace patina::daemon {
namespace {

class PreviewTest : public ::testing::Test {
 protected:
  PreviewTest() {
    const std::string id = bench_.start().id;
    bench_.watcher.waitForEnd(id);
    frame_ = *bench_.archive->reader().newestFrame(id);
  }
  SizePx sizeOf(int width) {
    const std::string jpeg = previews_.jpeg(bench_.archive->reader(), frame_, width);
    return readPictureHeader(std::as_bytes(std::span(jpeg.data(), jpeg.size()))).size;
  }
  Bench bench_;
  db::FrameRow frame_;
  Previews previews_;
};

TEST_F(PreviewTest, IsAsSmallAsAskedAndNeverLargerThanThePicture) {
  EXPECT_EQ(sizeOf(32), (SizePx{32, 24}));
  EXPECT_EQ(sizeOf(1024), (SizePx{64, 48}));
  EXPECT_EQ(sizeOf(1), (SizePx{16, 12}));
}

TEST_F(PreviewTest, IsKeptAndNeedsTheFileNoMore) {
  const std::string first = previews_.jpeg(bench_.archive->reader(), frame_, 32);
  std::filesystem::remove(bench_.archive->reader().pathOf(frame_));
  EXPECT_EQ(previews_.jpeg(bench_.archive->reader(), frame_, 32), first);
  EXPECT_THROW(previews_.jpeg(bench_.archive->reader(), frame_, 48), Failure);
}

TEST_F(PreviewTest, OfAFrameWhoseDriverMadeASmallOneNeedsNoFile) {
  Picture small;
  small.linear = Image<float>(64, 48, 3, 0.5F);
  previews_.take(frame_.sha256, thumbnailJpeg(small, kThumbnailPx));
  std::filesystem::remove(bench_.archive->reader().pathOf(frame_));
  EXPECT_EQ(sizeOf(32), (SizePx{32, 24}));
  EXPECT_THROW(sizeOf(kThumbnailPx + 1), Failure) << "a small one does not make a large one";
}

}  // namespace
}  // namespace patina::daemon
