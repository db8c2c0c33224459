// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/gc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "db/frame_store.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;
using namespace db::testing;
using namespace std::chrono_literals;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::IsEmpty;

constexpr Nanoseconds kDay = 24h;

class GcTest : public ::testing::Test {
 protected:
  GcTest() {
    ArchiveOptions options = optionsFor(path_);
    options.at_point = [this](CommitPoint point) {
      if (at_point_) at_point_(point);
    };
    archive_ = std::make_unique<Archive>(options);
    beginRun(*archive_);
    for (int number = 0; number < 3; ++number)
      capture(*archive_, number, static_cast<std::uint64_t>(number));
    const fs::path film = ProductWriter::folderFor(path_, "film-1") / "film.mp4";
    writeFile(film, "a film");
    ProductRow product;
    product.id = "film-1";
    product.kind = "film";
    product.path = "film.mp4";
    ProductWriter::add(path_, product);
  }
  // Whole frames that no row names, and leftovers of every other kind.
  void litter() {
    writeFrame(100);
    writeFile(path_ / "frames" / "letter.txt", "dear");
    writeFile(ProductWriter::folderFor(path_, "ttf-lost") / "ttf.h5", "a texture");
    fs::create_directories(path_ / "quarantine");
    writeFile(path_ / "quarantine" / "x-damaged.jpg", "half");
    writeFile(path_ / "tmp" / "17.jpg", "unfinished");
  }
  void writeFrame(std::uint64_t seed) {
    const Bytes bytes = frameBytes(seed);
    fs::create_directories(frame(seed).parent_path());
    writeFile(frame(seed), std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  fs::path frame(std::uint64_t seed) const {
    return path_ / framePath(sha256(frameBytes(seed)), "jpg");
  }
  GcReport sweep(Nanoseconds after, bool dry_run = false, FileOps* files = nullptr) {
    GcOptions options;
    options.grace = 7 * kDay;
    options.now = at(0) + after;
    options.dry_run = dry_run;
    options.files = files;
    return gc(path_, options, progress_);
  }
  std::vector<std::string> everything() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
      if (entry.path().string().find("catalog.sqlite") == std::string::npos)
        names.push_back(entry.path().string());
    std::ranges::sort(names);
    return names;
  }
  void expectNamedThere() {
    for (std::uint64_t seed = 0; seed < 3; ++seed) EXPECT_TRUE(fs::exists(frame(seed))) << seed;
    EXPECT_TRUE(fs::exists(path_ / "products" / "film-1" / "film.mp4"));
    for (const auto& p : verify(path_, progress_).problems)
      EXPECT_EQ(p.what, "orphan") << p.path << " " << p.detail;
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
  Progress progress_;
  std::function<void(CommitPoint)> at_point_;
  std::unique_ptr<Archive> archive_;  // the capturing process
};

TEST_F(GcTest, FindsNothingWhereEverythingIsNamed) {
  EXPECT_THAT(sweep(0 * kDay).items, IsEmpty());
  EXPECT_THAT(sweep(100 * kDay).items, IsEmpty());
  expectNamedThere();
}

TEST_F(GcTest, MarksThenTrashesThenFreesEachAfterItsGrace) {
  litter();
  EXPECT_EQ(sweep(0 * kDay).countOf(GcAction::kMarked), 5);
  EXPECT_EQ(sweep(6 * kDay).countOf(GcAction::kWaiting), 5);
  EXPECT_TRUE(fs::exists(frame(100)));
  const GcReport second = sweep(7 * kDay);
  EXPECT_EQ(second.countOf(GcAction::kTrashed), 4);
  EXPECT_EQ(second.countOf(GcAction::kFreed), 1) << "of tmp/";
  EXPECT_FALSE(fs::exists(frame(100)));
  EXPECT_TRUE(fs::exists(path_ / "trash" / frame(100).lexically_relative(path_)));
  EXPECT_EQ(sweep(13 * kDay).countOf(GcAction::kWaiting), 4);
  const GcReport third = sweep(14 * kDay);
  EXPECT_EQ(third.countOf(GcAction::kFreed), 4);
  EXPECT_EQ(third.bytesOf(GcAction::kFreed), 3000 + 4 + 9 + 4);
  EXPECT_THAT(sweep(15 * kDay).items, IsEmpty());
  EXPECT_FALSE(fs::exists(path_ / "trash" / "products" / "ttf-lost"));
  expectNamedThere();
}

TEST_F(GcTest, ADryRunChangesNothingAndSaysTheSame) {
  litter();
  const auto before = everything();
  EXPECT_EQ(sweep(0 * kDay, true).countOf(GcAction::kMarked), 5);
  EXPECT_EQ(everything(), before);
  sweep(0 * kDay);
  const auto marked = everything();
  EXPECT_EQ(sweep(7 * kDay, true).countOf(GcAction::kTrashed), 4);
  EXPECT_EQ(everything(), marked);
}

TEST_F(GcTest, WhatChangedStartsItsGraceAnew) {
  litter();
  sweep(0 * kDay);
  writeFile(path_ / "products" / "ttf-lost" / "ttf.h5", "a longer texture");
  const GcReport report = sweep(8 * kDay);
  EXPECT_EQ(report.countOf(GcAction::kMarked), 1);
  EXPECT_TRUE(fs::exists(path_ / "products" / "ttf-lost"));
}

TEST_F(GcTest, WhatIsNamedDuringItsGraceStays) {
  litter();
  sweep(0 * kDay);
  capture(*archive_, 3, 100);  // equal bytes: the file that lies there is taken
  ProductRow product;
  product.id = "ttf-lost";
  product.kind = "ttf";
  ProductWriter::add(path_, product);
  sweep(8 * kDay);
  sweep(20 * kDay);
  EXPECT_TRUE(fs::exists(frame(100)));
  EXPECT_TRUE(fs::exists(path_ / "products" / "ttf-lost" / "ttf.h5"));
  expectNamedThere();
}

TEST_F(GcTest, WhatIsNamedWhileItLiesInTheTrashComesBackOrIsPlacedAnew) {
  litter();
  sweep(0 * kDay);
  sweep(7 * kDay);
  capture(*archive_, 3, 100);
  EXPECT_TRUE(fs::exists(frame(100))) << "placed anew";
  sweep(30 * kDay);
  expectNamedThere();
}

TEST_F(GcTest, AClockThatWentBackMakesNothingOlder) {
  litter();
  sweep(100 * kDay);
  EXPECT_EQ(sweep(0 * kDay).countOf(GcAction::kMarked), 5);
  EXPECT_EQ(sweep(6 * kDay).countOf(GcAction::kWaiting), 5);
}

// A shot whose bytes lie in frames/ without a row finds them in the very moment they are swept: at
// every call of the sweep's disk, before and after.
TEST_F(GcTest, AShotCommittedAtAnyMomentOfASweepKeepsItsFrame) {
  int step = 3;
  for (int k = 0;; ++k) {
    const std::uint64_t seed = 100 + static_cast<std::uint64_t>(k);
    writeFrame(seed);
    sweep(k * 100 * kDay);
    int calls = 0;
    HookedDisk disk([&](Call, const fs::path&) {
      if (calls++ == k) capture(*archive_, step, seed);
      return 0;
    });
    sweep(k * 100 * kDay + 8 * kDay, false, &disk);
    if (calls <= k) break;
    EXPECT_TRUE(fs::exists(frame(seed))) << "committed at call " << k;
    ++step;
    ASSERT_LT(k, 300);
  }
  EXPECT_GT(step, 20);
  expectNamedThere();
}

// The other order: the shot has looked, and the sweep runs whole before it commits.
TEST_F(GcTest, ASweepBetweenAShotsLookAndItsCommitGivesTheFrameBack) {
  for (const CommitPoint point :
       {CommitPoint::kTmpSynced, CommitPoint::kFolderSynced, CommitPoint::kJournalSynced}) {
    const auto seed = 200 + static_cast<std::uint64_t>(point);
    writeFrame(seed);
    sweep(0 * kDay);
    std::int64_t trashed = 0;
    at_point_ = [&](CommitPoint p) {
      if (p == point) trashed = sweep(8 * kDay).countOf(GcAction::kTrashed);
    };
    capture(*archive_, 10 + static_cast<std::int64_t>(point), seed);
    at_point_ = {};
    EXPECT_EQ(trashed, point == CommitPoint::kTmpSynced ? 1 : 0) << name(point);
    EXPECT_TRUE(fs::exists(frame(seed))) << name(point);
  }
  expectNamedThere();
}

TEST_F(GcTest, KilledAtAnyCallItLosesNothingNamedAndGoesOn) {
  archive_.reset();  // no open database across a fork
  for (int k = 0;; ++k) {
    litter();
    fs::remove_all(path_ / "care");
    fs::remove_all(path_ / "trash");
    sweep(0 * kDay);
    const pid_t child = ::fork();
    if (child == 0) {
      int calls = 0;
      HookedDisk disk([&](Call, const fs::path&) {
        if (calls++ == k) ::_exit(9);
        return 0;
      });
      sweep(7 * kDay, false, &disk);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    expectNamedThere();
    // Marks of what had not moved yet were kept; what had is marked in the trash from now on.
    sweep(8 * kDay);
    sweep(16 * kDay);
    EXPECT_THAT(sweep(17 * kDay).items, IsEmpty()) << "killed at call " << k;
    if (WEXITSTATUS(status) == 0) break;
    ASSERT_LT(k, 300);
  }
}

TEST_F(GcTest, OneSweepAtATime) {
  litter();
  sweep(0 * kDay);
  HookedDisk disk([&](Call call, const fs::path&) {
    if (call == Call::kRename) {
      EXPECT_THROW(sweep(7 * kDay), ArchiveError);
    }
    return 0;
  });
  sweep(7 * kDay, false, &disk);
}

TEST_F(GcTest, AFolderThatIsNoArchiveIsLeftAlone) {
  GcOptions options;
  EXPECT_THROW(gc(folder_ / "nothing", options, progress_), ArchiveError);
  EXPECT_FALSE(fs::exists(folder_ / "nothing"));
}

}  // namespace
}  // namespace patina::db::care
