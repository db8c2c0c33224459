// SPDX-License-Identifier: GPL-3.0-or-later
// The judge must be able to condemn.
#include "tests/support/disk/archive_life.h"

#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class Judged : public ::testing::Test {
 protected:
  Judged() {
    db::ArchiveOptions options;
    options.folder = folder_ / "archive";
    liveOn(options, 3, 1, [this](const Acked& acked) { judge_.note(acked), last_ = acked; });
  }
  std::filesystem::path frameFile() const {
    const auto folder = folder_ / "archive" / "frames" / last_.sha256.substr(0, 2);
    return folder / (last_.sha256.substr(2) + ".dng");
  }
  std::vector<std::string> problems() const { return judge_.judgeRecovered(folder_ / "archive"); }

  TempFolder folder_ = TempFolder::inMemory();
  Judge judge_;
  Acked last_;
};

TEST_F(Judged, AcquitsAnArchiveThatKeptItsPromises) {
  EXPECT_EQ(judge_.count(), 6u);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(Judged, CondemnsAFrameThatWasAcknowledgedAndHasNoRow) {
  Acked lost = last_;
  lost.sha256[0] = lost.sha256[0] == '0' ? '1' : '0';
  judge_.note(lost);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("lost")));
}

TEST_F(Judged, CondemnsOtherBytesUnderTheSameName) {
  std::string bytes = readFile(frameFile());
  bytes[100] ^= 1;
  writeFile(frameFile(), bytes);
  EXPECT_THAT(problems(), SizeIs(2)) << "the reader and verify";
}

TEST_F(Judged, CondemnsAFileThatIsGone) {
  std::filesystem::remove(frameFile());
  EXPECT_THAT(problems(), SizeIs(2)) << "the reader and verify";
}

TEST_F(Judged, CondemnsAFrameInAnotherStepOrShot) {
  Acked moved = last_;
  moved.step = 0;
  judge_.note(moved);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("another step")));
  moved = last_;
  moved.shot_id = 1;
  judge_.note(moved);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("another shot")));
}

TEST_F(Judged, CondemnsAGapInTheSteps) {
  {
    db::ArchiveOptions options;
    options.folder = folder_ / "archive";
    db::Archive archive(options);
    db::StepRow step;
    step.run_id = archive.reader().runs().back().id;
    step.number = 5;
    step.decision = db::Decision::kMissed;
    archive.beginStep(step);
  }
  EXPECT_THAT(problems(), ElementsAre("step 5 instead of 3"));
}

}  // namespace
}  // namespace patina::testing
