// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/errors.h"
#include "db/recovery.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class OrphansTest : public ::testing::Test {
 protected:
  OrphansTest() {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    capture(archive, 0, 1);
  }
  fs::path plant(std::uint64_t seed) {
    const Bytes bytes = frameBytes(seed);
    fs::path path = path_ / framePath(sha256(bytes), "jpg");
    fs::create_directories(path.parent_path());
    writeFileAtomically(path, bytes);
    return path;
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
};

TEST_F(OrphansTest, AFrameFileThatNobodyKnowsIsSetAsideAndSaid) {
  const auto orphan = plant(50);
  const Archive archive(optionsFor(path_));
  EXPECT_EQ(archive.recovery().frames_quarantined, 1);
  EXPECT_FALSE(fs::exists(orphan));
  EXPECT_EQ(readFile(path_ / "quarantine" / (sha256(frameBytes(50)).hex() + ".jpg")),
            frameBytes(50));
  EXPECT_THAT(archive.reader().events(""), SizeIs(1));
  EXPECT_TRUE(fs::exists(archive.reader().pathOf(*archive.reader().newestFrame(kRunId))));
}

TEST_F(OrphansTest, WhatADeadStartSetAsideStaysAside) {
  plant(50);
  bool dies = true;
  std::string order;
  HookedDisk disk([&](Call call, const fs::path& path) {
    const bool aside = call == Call::kSyncFolder && path == path_ / "quarantine";
    if (aside && dies) return -EIO;
    if (aside) order += "quarantine ";
    if (call == Call::kWrite && path.extension() == ".jsonl") order += "journal ";
    return 0;
  });
  EXPECT_THROW(Archive(optionsFor(path_, &disk)), ArchiveError);
  dies = false;
  Archive archive(optionsFor(path_, &disk));
  archive.addEvent({0, kRunId, at(600), "note", "here again"});
  EXPECT_EQ(order, "quarantine journal ") << "a power cut would bring it back, older than a line";
}

TEST_F(OrphansTest, FoldersOlderThanTheJournalsAreNotLookedInto) {
  const auto orphan = plant(50);
  fs::last_write_time(orphan.parent_path(),
                      fs::last_write_time(journalPath(path_, kRunId)) - std::chrono::hours(1));
  EXPECT_EQ(Archive(optionsFor(path_)).recovery().frames_quarantined, 0);
  Progress progress;
  ASSERT_THAT(verify(path_, progress).problems, SizeIs(1));
  EXPECT_EQ(verify(path_, progress).problems[0].what, "orphan");
  EXPECT_EQ(rebuild(path_, progress).frames_quarantined, 1);
  EXPECT_THAT(verify(path_, progress).problems, IsEmpty());
}

TEST_F(OrphansTest, OnlyAHashIsTheNameOfAFrame) {
  const std::string hex = sha256(frameBytes(1)).hex();
  EXPECT_TRUE(parseFramePath(path_ / framePath(sha256(frameBytes(1)), "nef")));
  EXPECT_FALSE(parseFramePath("frames/ab/cd.jpg"));
  EXPECT_FALSE(parseFramePath("frames/" + hex.substr(0, 2) + "/" + hex.substr(2)));
  EXPECT_FALSE(parseFramePath("frames/zz/" + hex.substr(2) + ".jpg"));
}

}  // namespace
}  // namespace patina::db::testing
