// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/import.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::import;
using testing::importOf;
using testing::plantPng;
using testing::plantPngs;
using testing::TempFolder;
using testing::writeFile;

class Import : public ::testing::Test {
 protected:
  Import() { plantPngs(source_, 4); }
  std::int64_t problems() {
    Progress progress;
    return static_cast<std::int64_t>(db::verify(archive_, progress).problems.size());
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path source_ = folder_ / "pictures", archive_ = folder_ / "archive";
};

TEST_F(Import, KeepsEveryFileByteForByte) {
  const ImportReport report = import(importOf(source_, archive_));
  EXPECT_EQ(report.captured, 4);
  const db::ArchiveReader reader(archive_);
  const auto step = reader.step(report.run_id, 2);
  ASSERT_TRUE(step);
  const auto frames = reader.framesOfStep(step->id);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(reader.read(frames[0]), readFile(source_ / "frame2.png"));
  EXPECT_EQ(reader.runs().back().state, "imported");
  EXPECT_EQ(problems(), 0);
}

TEST_F(Import, NamesBrokenFilesAndBringsTheRest) {
  const std::string whole = testing::readFile(source_ / "frame1.png");
  writeFile(source_ / "frame1.png", whole.substr(0, whole.size() / 2));
  writeFile(source_ / "frame2.png", "");
  writeFile(source_ / "frame3.jpg", whole);  // a PNG that says it is a JPEG is still a picture
  const ImportReport report = import(importOf(source_, archive_));
  std::vector<std::string> names;
  for (const RejectedFile& file : report.rejected) names.push_back(file.file);
  EXPECT_THAT(names, ::testing::ElementsAre("frame1.png", "frame2.png"));
  EXPECT_EQ(report.failed, 2);
  EXPECT_EQ(report.captured, 3);
  EXPECT_FALSE(std::filesystem::is_empty(archive_ / "quarantine"));
  EXPECT_EQ(problems(), 0);
}

TEST_F(Import, OfNothingUsableIsBadData) {
  for (int i = 0; i < 4; ++i) writeFile(source_ / ("frame" + std::to_string(i) + ".png"), "no");
  try {
    import(importOf(source_, archive_));
    FAIL();
  } catch (const WorkflowError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
  }
  EXPECT_EQ(db::ArchiveReader(archive_).runs().back().state, "aborted");
}

TEST_F(Import, OfEqualPicturesKeepsOneFileAndTwoRows) {
  std::filesystem::copy_file(source_ / "frame3.png", source_ / "frame4.png");
  const ImportReport report = import(importOf(source_, archive_));
  EXPECT_EQ(report.captured, 5);
  const db::ArchiveReader reader(archive_);
  std::vector<std::filesystem::path> paths;
  reader.eachFrame(report.run_id,
                   [&](const auto& one) { paths.push_back(reader.pathOf(one.frame)); });
  ASSERT_EQ(paths.size(), 5u);
  EXPECT_EQ(paths[3], paths[4]);
  EXPECT_EQ(problems(), 0);
}

TEST_F(Import, IsRefusedASecondTimeUnlessItIsMeant) {
  const std::string first = import(importOf(source_, archive_)).run_id;
  EXPECT_THROW(import(importOf(source_, archive_)), WorkflowError);
  ImportOptions again = importOf(source_, archive_);
  again.again = true;
  EXPECT_NE(import(again).run_id, first);
  EXPECT_EQ(db::ArchiveReader(archive_).runs().size(), 2u);
}

class StopAfter final : public Progress {
 public:
  explicit StopAfter(int steps) : left_(steps) {}

 protected:
  void advance(std::int64_t) override {
    if (--left_ == 0) askToStop();
  }

 private:
  int left_;
};

TEST_F(Import, InterruptedGoesOnWhereItStopped) {
  StopAfter progress(2);
  EXPECT_THROW(importPictures(importOf(source_, archive_), testing::now, progress), Stopped);
  EXPECT_EQ(db::ArchiveReader(archive_).runs().back().state, "running");
  const ImportReport report = import(importOf(source_, archive_));
  EXPECT_TRUE(report.resumed);
  EXPECT_EQ(report.captured, 4);
  std::int64_t frames = 0;
  db::ArchiveReader(archive_).eachFrame(report.run_id, [&](const auto&) { ++frames; });
  EXPECT_EQ(frames, 4);
  EXPECT_EQ(problems(), 0);
}

TEST_F(Import, ReportsUnequalSizes) {
  plantPng(source_ / "frame4.png", {25, 15}, 90);
  const ImportReport report = import(importOf(source_, archive_));
  EXPECT_EQ(report.sizes, 2);
  EXPECT_EQ(report.smallest, (SizePx{24, 15}));
  EXPECT_EQ(report.largest, (SizePx{25, 16}));
}

TEST_F(Import, WaitsForNobodyWhenTheArchiveHasAnOwner) {
  db::ArchiveOptions options;
  options.folder = archive_;
  options.owner = "patina capture";
  const db::Archive owner(options);
  try {
    import(importOf(source_, archive_));
    FAIL();
  } catch (const db::ArchiveError& error) {
    EXPECT_EQ(error.exit(), Exit::kTemporary);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("patina capture"));
  }
}

}  // namespace
}  // namespace patina::workflow
