// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/libav.h"

extern "C" {
#include <libavutil/error.h>
#include <libavutil/frame.h>
}

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Libav, FreesWhatItOwnsAndTellsErrorsAsText) {
  LibavPtr<AVFrame> frame(av_frame_alloc());
  ASSERT_NE(frame, nullptr);
  frame.reset();
  EXPECT_EQ(libavText(AVERROR_EOF), "End of file");
}

}  // namespace
}  // namespace patina
