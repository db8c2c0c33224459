// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/metadata.h"

#include <gmock/gmock.h>

namespace patina::devices::libcamera {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

Controls asked() { return {10ms, 2.0, {{1.5, 2.5}}, 4.0}; }
Metadata exactly(const Controls& controls) { return {controls, 1.0, {}, 0}; }

TEST(Metadata, WhatIsWithinOnePercentIsThePicture) {
  Metadata frame = exactly(asked());
  frame.applied.exposure = 10099us;
  frame.applied.analogue_gain = 1.981;
  frame.digital_gain = 1.009;
  EXPECT_EQ(judge(asked(), frame).kind, Verdict::kTaken);
}

TEST(Metadata, WhatDiffersByMoreIsNotAndSaysHow) {
  std::vector<Metadata> frames(6, exactly(asked()));
  frames[0].applied.exposure = 10101us;
  frames[1].applied.analogue_gain = 2.03;
  frames[2].digital_gain = 1.02;
  frames[3].applied.colour_gains = {{1.5, 2.6}};
  frames[4].applied.colour_gains = {{1.4, 2.5}};
  frames[5].applied.focus_dioptres = 4.1;
  const char* const names[] = {
      "exposure: asked 0.01 s, got 0.010101 s", "analogue gain: asked 2, got 2.03",
      "digital gain: asked 1, got 1.02",        "blue gain: asked 2.5, got 2.6",
      "red gain: asked 1.5, got 1.4",           "focus: asked 4 dioptres, got 4.1 dioptres"};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Verdict verdict = judge(asked(), frames[i]);
    EXPECT_EQ(verdict.kind, Verdict::kDiffers);
    EXPECT_THAT(verdict.why, HasSubstr(names[i]));
  }
}

TEST(Metadata, NotANumberIsNotThePicture) {
  Metadata frame = exactly(asked());
  frame.applied.analogue_gain = std::nan("");
  EXPECT_EQ(judge(asked(), frame).kind, Verdict::kDiffers);
}

TEST(Metadata, ExposureAndGainMustBeSaidTheRestMay) {
  Metadata frame = exactly(asked());
  frame.applied.colour_gains.reset();
  frame.applied.focus_dioptres.reset();
  frame.digital_gain.reset();
  EXPECT_EQ(judge(asked(), frame).kind, Verdict::kTaken);
  frame.applied.analogue_gain.reset();
  EXPECT_EQ(judge(asked(), frame).kind, Verdict::kUnsaid);
  frame = exactly(asked());
  frame.applied.exposure.reset();
  EXPECT_EQ(judge(asked(), frame).kind, Verdict::kUnsaid);
}

TEST(Metadata, WhatWasNotAskedIsNotHeldAgainstAFrame) {
  Metadata frame = exactly(asked());
  EXPECT_EQ(judge(Controls{}, frame).kind, Verdict::kTaken);
}

}  // namespace
}  // namespace patina::devices::libcamera
