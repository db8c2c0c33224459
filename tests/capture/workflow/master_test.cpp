// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/master.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class Masters : public ::testing::Test {
 protected:
  MasterOutcome make(const MasterRequest& request) {
    Progress progress;
    return makeMaster(archive_, request, testing::now(), progress);
  }
  Image<float> firstFrame() {
    const db::ArchiveReader reader(archive_);
    FrameSelection selection;
    selection.light = "key";
    ArchiveFrames frames(reader, reader.runs().back().id, selection, {});
    Image<float> image = frames.next()->linear;
    report_ = frames.report();
    bound_ = frames.bindings().size();
    return image;
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  FramesReport report_;
  std::size_t bound_ = 0;
};

TEST_F(Masters, OfARunAreBoundToItsFramesAndSubtracted) {
  testing::MadeShot lit, dark;
  dark.light = "off";
  dark.level = 20;
  testing::makeRun(archive_, std::vector<testing::MadeStep>(4, {{lit, dark}}));
  EXPECT_EQ(bound_, 0u);
  MasterRequest request;
  request.kind = "dark";
  request.run = "latest";
  request.selection.light = "off";
  const MasterOutcome outcome = make(request);
  EXPECT_EQ(outcome.report.frames, 4);
  EXPECT_NEAR(firstFrame().at(2, 2, 0), linearFromSrgb(100.0f / 255) - linearFromSrgb(20.0f / 255),
              1e-5);
  ASSERT_EQ(report_.masters.size(), 1u);
  EXPECT_THAT(report_.masters[0], ::testing::StartsWith("dark 1: "));
  EXPECT_EQ(bound_, 4u);
}

TEST_F(Masters, OfAnotherExposureAreNotUsedAndSaidNotToBe) {
  testing::makeRun(archive_, {{{testing::MadeShot{}}}});
  testing::plantPngs(folder_ / "darks", 3);
  MasterRequest request;
  request.kind = "dark";
  request.folder = folder_ / "darks";
  request.camera = "cam0";
  request.exposure = std::chrono::seconds(2);
  request.iso = 100;
  make(request);
  EXPECT_NEAR(firstFrame().at(2, 2, 0), linearFromSrgb(100.0f / 255), 1e-6);
  EXPECT_TRUE(report_.masters.empty());
  EXPECT_EQ(report_.masters_left.size(), 1u);
}

TEST_F(Masters, NeedACamera) {
  testing::makeRun(archive_, {{{testing::MadeShot{}}}});
  testing::plantPngs(folder_ / "darks", 3);
  MasterRequest request;
  request.kind = "dark";
  request.folder = folder_ / "darks";
  EXPECT_THROW(make(request), WorkflowError);
}

TEST_F(Masters, AFlatWithoutADarkSaysSo) {
  testing::makeRun(archive_, {{{testing::MadeShot{}}}});
  testing::plantPngs(folder_ / "flats", 0);
  for (int i = 0; i < 3; ++i)
    testing::plantPng(folder_ / "flats" / (std::to_string(i) + ".png"), {24, 16}, 180 + i);
  MasterRequest request;
  request.kind = "flat";
  request.folder = folder_ / "flats";
  request.camera = "cam0";
  request.exposure = std::chrono::milliseconds(20);
  EXPECT_THAT(make(request).notes, ::testing::Contains(::testing::HasSubstr("no dark")));
}

TEST_F(Masters, OfPicturesThatDoNotSayTheirExposureAskForIt) {
  testing::makeRun(archive_, {{{testing::MadeShot{}}}});
  testing::plantPngs(folder_ / "darks", 3);
  MasterRequest request;
  request.kind = "dark";
  request.folder = folder_ / "darks";
  request.camera = "cam0";
  try {
    make(request);
    ADD_FAILURE() << "not refused";
  } catch (const WorkflowError& error) {
    EXPECT_EQ(error.exit(), Exit::kUsage);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("--exposure-time"));
  }
}

}  // namespace
}  // namespace patina::workflow
