// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/frame_chain.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class Chain : public ::testing::Test {
 protected:
  Chain() {
    testing::makeRun(archive_, std::vector<testing::MadeStep>(3, {{testing::MadeShot{}}}));
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  Progress progress_;
};

TEST_F(Chain, WithoutAnyLinkGivesTheArchivesFrames) {
  const db::ArchiveReader reader(archive_);
  const db::RunRow run = reader.runs().back();
  FrameChain chain(reader, run, {}, progress_);
  ArchiveFrames plain(reader, run.id, {}, {});
  EXPECT_EQ(chain.size(), plain.report().size);
  EXPECT_EQ(chain.source().count(), 3);
  EXPECT_EQ(chain.source().next()->linear.texels(), plain.next()->linear.texels());
  EXPECT_EQ(chain.mmPerTexel(), 0);
  EXPECT_TRUE(chain.calibrations().empty());
  EXPECT_TRUE(chain.bindings().empty());
  Making making;
  chain.addInputs(making);
  EXPECT_EQ(making.input_sha256s, plain.report().input_sha256s);
}

TEST_F(Chain, RegistersWhatStandsStillWithoutChangingIt) {
  const db::ArchiveReader reader(archive_);
  const db::RunRow run = reader.runs().back();
  FrameRequest request;
  request.registration.emplace();
  FrameChain chain(reader, run, request, progress_);
  Facts options;
  chain.addOptions(options);
  EXPECT_EQ(options.text("register"), "translation");
}

TEST_F(Chain, SaysWhatIsMissingBeforeItDecodesAnything) {
  const db::ArchiveReader reader(archive_);
  const db::RunRow run = reader.runs().back();
  FrameRequest by_view, by_chart, without_ambient;
  by_view.rectify.emplace();
  by_chart.colour = calibration::ColourSpace::kXyz;
  without_ambient.lamps.ambient = true;
  for (const FrameRequest& request : {by_view, by_chart, without_ambient})
    EXPECT_THROW(FrameChain(reader, run, request, progress_), WorkflowError);
}

TEST(RectText, IsAsOptionsWriteIt) { EXPECT_EQ(rectText({1, 2, 30, 40}), "1,2,30,40"); }

}  // namespace
}  // namespace patina::workflow
