// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/scrub.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

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
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ScrubTest : public ::testing::Test {
 protected:
  ScrubTest() {
    archive_ = std::make_unique<Archive>(optionsFor(path_, &disk_));
    beginRun(*archive_);
  }
  void shoot(int frames) {
    StepRow step = stepRow(number_++);
    step.id = archive_->beginStep(step);
    ShotRow shot = shotRow(step);
    shot.id = archive_->armShot(shot);
    std::vector<Bytes> bytes;
    std::vector<PendingFrame> pending;
    for (int i = 0; i < frames; ++i) bytes.push_back(frameBytes(seed_++, 200));
    for (int i = 0; i < frames; ++i)
      pending.push_back(pendingFrame(shot, bytes[static_cast<std::size_t>(i)], i));
    step.decision = Decision::kCaptured;
    archive_->acknowledge(shot, pending, {}, step.due_utc, &step);
  }
  fs::path frame(std::uint64_t seed) const {
    return path_ / framePath(sha256(frameBytes(seed, 200)), "jpg");
  }
  void flip(std::uint64_t seed) const {
    std::string bytes = readFile(frame(seed));
    const std::uint64_t bit = hashSeed(seed, 7) % (bytes.size() * 8);
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << (bit % 8)));
    writeFile(frame(seed), bytes);
  }
  // A slice whose clock stands still: it ends after `frames` looks at the clock.
  ScrubReport slice(int frames = 1'000'000, UtcTime now = at(0)) {
    ScrubOptions options;
    std::int64_t looks = 0;
    options.mono = [&looks] { return monoFromNs(looks++); };
    options.utc = [now] { return now; };
    options.max_duration = Nanoseconds{frames};
    return scrub(path_, options, progress_);
  }
  std::vector<EventRow> events() const { return ArchiveReader(path_).events({}); }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
  HookedDisk disk_;
  std::uint64_t seed_ = 0;
  int number_ = 0;
  Progress progress_;
  std::unique_ptr<Archive> archive_;  // the capturing process
};

TEST_F(ScrubTest, FindsEachOfAThousandFlippedBits) {
  for (int i = 0; i < 11; ++i) shoot(100);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) flip(seed);
  const ScrubReport report = slice();
  EXPECT_EQ(report.frames, 1100);
  std::set<std::string> found;
  for (const ScrubProblem& p : report.problems) {
    EXPECT_EQ(p.what, "hash");
    found.insert(p.path);
  }
  EXPECT_EQ(found.size(), 1000u);
  EXPECT_EQ(events().size(), 1001u) << "one each, and the slice's own";
  EXPECT_THAT(verify(path_, progress_).problems.size(), 1000u);
}

TEST_F(ScrubTest, GoesOnWhereItStoppedAndThenBeginsWithTheOldest) {
  shoot(10);
  EXPECT_EQ(slice(4, at(0)).frames, 4);
  EXPECT_EQ(slice(4, at(100)).unchecked, 2);
  const ScrubReport third = slice(4, at(200));
  EXPECT_EQ(third.frames, 4);
  EXPECT_EQ(third.unchecked, 0);
  EXPECT_EQ(third.oldest_check, at(0));
  flip(2);  // the third frame's check is the oldest now
  flip(3);
  EXPECT_EQ(slice(1, at(300)).problems.size(), 1u);
  EXPECT_EQ(slice(1, at(400)).problems.size(), 1u);
  EXPECT_THAT(slice(1, at(500)).problems, IsEmpty());
}

TEST_F(ScrubTest, NewFramesComeBeforeASecondLook) {
  shoot(5);
  slice();
  shoot(1);
  flip(5);
  const ScrubReport report = slice(1, at(100));
  EXPECT_EQ(report.frames, 1);
  EXPECT_EQ(report.problems.size(), 1u);
}

TEST_F(ScrubTest, TellsMissingFromCutAndDamaged) {
  shoot(4);
  fs::remove(frame(0));
  fs::resize_file(frame(1), 100);
  flip(2);
  const ScrubReport report = slice();
  ASSERT_EQ(report.problems.size(), 3u);
  EXPECT_EQ(report.problems[0].what, "missing");
  EXPECT_EQ(report.problems[1].what, "size");
  EXPECT_EQ(report.problems[2].what, "hash");
  EXPECT_EQ(report.problems[0].run_id, kRunId);
}

TEST_F(ScrubTest, ItsRowsStandBesideThoseOfTheCapturingProcess) {
  shoot(2);
  flip(0);
  slice();
  archive_->addEvent({0, {}, at(5), "disk", "of the owner"});
  slice(1'000'000, at(100));
  archive_->addEvent({0, kRunId, at(6), "alarm", "of the owner"});
  EXPECT_EQ(events().size(), 5u);
  EXPECT_THAT(events()[0].detail + events()[1].detail, HasSubstr(frame(0).filename().string()));
  archive_.reset();
  archive_ = std::make_unique<Archive>(optionsFor(path_, &disk_));
  archive_->addEvent({0, {}, at(7), "disk", "after a start"});
  for (const auto& p : verify(path_, progress_).problems) EXPECT_EQ(p.what, "hash") << p.detail;
}

TEST_F(ScrubTest, KilledAtAnyCallItForgetsNoDamage) {
  shoot(30);
  flip(3);
  flip(29);
  archive_.reset();  // no open database across a fork
  for (int k = 0;; k += 5) {
    fs::remove_all(path_ / "care");
    const auto before = events().size();
    const pid_t child = ::fork();
    if (child == 0) {
      int calls = 0;
      HookedDisk disk([&](Call, const fs::path&) {
        if (calls++ == k) ::_exit(9);
        return 0;
      });
      ScrubOptions options;
      options.mono = [] { return MonoTime{}; };
      options.utc = [] { return at(0); };
      options.files = &disk;
      scrub(path_, options, progress_);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    slice(1'000'000, at(100));
    int damage = 0;
    const auto all = events();
    for (std::size_t i = 0; i + before < all.size(); ++i) damage += all[i].kind == "scrub_damage";
    EXPECT_GE(damage, 2) << "killed at call " << k;
    if (WEXITSTATUS(status) == 0) break;
    ASSERT_LT(k, 1000);
  }
}

TEST_F(ScrubTest, StopsWhenAskedAndKeepsWhatItDid) {
  shoot(3);
  Progress stopped;
  stopped.askToStop();
  ScrubOptions options;
  options.mono = [] { return MonoTime{}; };
  options.utc = [] { return at(0); };
  EXPECT_THROW(scrub(path_, options, stopped), Stopped);
  EXPECT_EQ(slice().frames, 3);
}

TEST_F(ScrubTest, AnEmptyArchiveIsWhole) {
  const ScrubReport report = slice();
  EXPECT_EQ(report.frames, 0);
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_THROW(scrub(folder_ / "nothing", {}, progress_), ArchiveError);
}

}  // namespace
}  // namespace patina::db::care
