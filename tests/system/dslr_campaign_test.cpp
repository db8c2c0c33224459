// SPDX-License-Identifier: GPL-3.0-or-later
// Over PTP/IP. PATINA_DSLR_SHOTS, PATINA_DSLR_SEED: see dslr_campaign.h.
#include "tests/system/dslr_campaign.h"

#include <gmock/gmock.h>

namespace patina::testing {
namespace {

// PATINA_DSLR_CALM_SHOTS: how many shots (8), of one process.
TEST_F(DslrCampaign, AWellBehavedCameraGivesEveryShot) {
  const int shots = numberFrom("PATINA_DSLR_CALM_SHOTS", 8);
  const auto summary = run({}, shots, shots > 8 ? 1200 : 4000);
  const DslrVerdict v = verdict();
  std::printf("%d shots due, %zu frames; %s\n%s\n%s\n", shots, v.frames, story().c_str(),
              times_->text().c_str(), drivers_.text().c_str());
  EXPECT_THAT(v.broken, ::testing::IsEmpty());
  EXPECT_EQ(v.frames, static_cast<std::size_t>(shots));
  EXPECT_EQ(thumbnails_, v.frames);
  EXPECT_LE(v.on_card, 1u);  // whose release the session's end overtook
  EXPECT_EQ(summary.last.captured, shots / kShotsAStep);
  EXPECT_EQ(drivers_.growth().descriptors, 0);
}

TEST_P(DslrCampaign, NoPictureIsLostDoubledOrMisplacedWhateverTheCameraDoes) {
  misbehaveThroughout(false);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DslrCampaign, ::testing::Range(0, 4));

}  // namespace
}  // namespace patina::testing
