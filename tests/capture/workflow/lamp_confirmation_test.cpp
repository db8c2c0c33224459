// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lamp_confirmation.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/dng_file.h"
#include "tests/calibration/lamps/lamp_ring.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::MadeShot;
using testing::MadeStep;
using ::testing::ThrowsMessage;

// Two lamps, fill (0) and key (1), over cracking paint.
class LampConfirmations : public ::testing::Test {
 protected:
  LampConfirmations() {
    calibration::LampRing ring;
    ring.specimen = "paint_cracking";
    ring.size = "128x128";
    ring.lamps_mm = {{-250, 60, 200}, {220, 150, 260}};
    twin_.emplace(ring);
  }
  // A shot whose row says `light`, under these lamps.
  MadeShot shot(const std::string& light, double fill, double key) {
    MadeShot made;
    made.light = light;
    made.size = {128, 128};
    made.exposed = std::chrono::milliseconds(20);
    made.dng = encodeDng(
        twin_->maker().expose(twin_->shotAt({fill, key}, std::chrono::milliseconds(20), ++shots_)));
    return made;
  }
  LampConfirmation confirm(const std::vector<MadeStep>& steps) {
    testing::makeRun(folder_.path(), steps);
    const db::ArchiveReader reader(folder_.path());
    Progress progress;
    return confirmLamps(reader, reader.runs().back().id, {}, progress);
  }
  std::optional<calibration::RingTwin> twin_;
  int shots_ = 0;
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(LampConfirmations, HoldWhereEveryFrameHasItsOwnLampHoweverDim) {
  const LampConfirmation found = confirm({{{shot("fill", 1, 0), shot("key", 0, 1)}},
                                          {{shot("fill", 0.6, 0), shot("key", 0, 0.8)}},
                                          {{shot("fill", 1, 0), shot("key", 0, 1)}}});
  EXPECT_TRUE(found.all());
  EXPECT_TRUE(found.told.empty());
  ASSERT_EQ(found.states.size(), 2u);
  EXPECT_EQ(found.states[1].light, "key");
  EXPECT_EQ(found.states[1].confirmed, 3);
  EXPECT_GT(found.states[1].margin_least, 0.5);
  EXPECT_THAT(found.verdict(), HasSubstr("Every frame"));
}

TEST_F(LampConfirmations, NameTheFramesUnderExchangedAndDeadLamps) {
  const LampConfirmation found = confirm({{{shot("fill", 1, 0), shot("key", 0, 1)}},
                                          {{shot("fill", 0, 1), shot("key", 1, 0)}},
                                          {{shot("fill", 0, 1), shot("key", 0, 0)}},
                                          {{shot("fill", 1, 0), shot("key", 0, 1)}}});
  EXPECT_FALSE(found.all());
  EXPECT_EQ(found.states[0].other, 2);
  EXPECT_EQ(found.states[1].other, 1);
  EXPECT_EQ(found.states[1].dark, 1);
  EXPECT_EQ(found.states[1].confirmed, 2) << "and the last one is well again";
  ASSERT_EQ(found.told.size(), 4u);
  EXPECT_THAT(found.told[0], HasSubstr("fill: lit by key"));
  EXPECT_THAT(found.told[3], HasSubstr("key: no lamp was lit"));
  EXPECT_THAT(found.verdict(), HasSubstr("4 of 8 frames have another light"));
}

TEST_F(LampConfirmations, NeedTwoStatesToTellApart) {
  EXPECT_THAT(([&] { confirm({{{shot("key", 0, 1)}}}); }),
              ThrowsMessage<WorkflowError>(HasSubstr("one light state")));
}

}  // namespace
}  // namespace patina::workflow
