// SPDX-License-Identifier: GPL-3.0-or-later
// Every call of a run's disk fails once, with each error, under a caller that goes on with the same
// Archive as long as it may: nothing acknowledged is lost, and no file is synced again after EIO.
// PATINA_CALL_FRAMES is the length of the run; the long form sets it.
#include <gmock/gmock.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "db/archive.h"
#include "tests/db/small_run.h"
#include "tests/support/disk/archive_life.h"
#include "tests/support/disk/failing_file_ops.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::Acked;
using patina::testing::FailingFileOps;
using patina::testing::Judge;
using patina::testing::TempFolder;
using ::testing::IsEmpty;

int framesAskedFor() {
  const char* text = std::getenv("PATINA_CALL_FRAMES");
  return text != nullptr ? std::atoi(text) : 3;
}

// The short form lets each call fail with one of the errors in turn; the long one with each.
bool isTurnOf(int turn, std::int64_t k) {
  return std::getenv("PATINA_CALL_FRAMES") != nullptr || k % 4 == turn;
}

enum class Fault { kNone, kError, kShortWrite };

class Run {
 public:
  explicit Run(const std::filesystem::path& folder) : folder_(folder) {}

  // A stubborn caller: what fails is tried again in the next step, with the same Archive.
  void live(FailingFileOps& disk, int frames) {
    try {
      Archive archive(optionsFor(folder_, &disk));
      if (!archive.runState(kRunId)) beginRun(archive);
      const std::int64_t first = archive.runState(kRunId)->last_number.value_or(-1) + 1;
      for (std::int64_t number = first; number < first + frames; ++number) shoot(archive, number);
    } catch (const ArchiveError&) {
      ++failures_;
    }
  }
  int failures() const { return failures_; }
  std::size_t acked() const { return judge_.count(); }
  std::vector<std::string> judge() const { return judge_.judgeRecovered(folder_); }

 private:
  void shoot(Archive& archive, std::int64_t number) {
    try {
      if (number % 3 == 1) archive.addEvent({0, kRunId, at(number), "note", "a third"});
      if (number % 3 == 2)
        archive.addDevice({"lux" + std::to_string(number), "sensor", "twin", "", ""});
      for (const FrameRow& row : capture(archive, number, static_cast<std::uint64_t>(number)))
        judge_.note({row.sha256.hex(), number, 0, row.shot_id});
    } catch (const ArchiveError&) {
      ++failures_;
    }
  }

  std::filesystem::path folder_;
  Judge judge_;
  int failures_ = 0;
};

// Each step has its row in a run that was never disturbed; a failed one may leave none.
void dropGaps(std::vector<std::string>& problems) {
  std::erase_if(problems,
                [](const std::string& p) { return p.find(" instead of ") != std::string::npos; });
}

struct Outcome {
  std::int64_t calls = 0;
  int failures = 0;
};

Outcome failCall(std::int64_t k, Fault fault, int error, int frames) {
  const TempFolder folder = TempFolder::inMemory();
  Run run(folder / "archive");
  FailingFileOps disk;
  if (fault == Fault::kError) disk.failCall(k, error);
  if (fault == Fault::kShortWrite) disk.writeShort(k);
  run.live(disk, frames);
  const Outcome outcome{disk.calls(), run.failures()};
  EXPECT_EQ(disk.syncsAfterFailure(), 0) << "a file was synced again after EIO";
  disk.heal();
  run.live(disk, 1);
  EXPECT_EQ(run.failures(), outcome.failures) << "the healed disk does not help";
  EXPECT_GT(run.acked(), 0u);
  auto problems = run.judge();
  if (fault == Fault::kError) dropGaps(problems);
  EXPECT_THAT(problems, IsEmpty());
  return outcome;
}

void failEveryCall(int turn, Fault fault, int error, const char* name) {
  const int frames = framesAskedFor();
  std::int64_t failed = 0, tried = 0, calls = 0;
  bool met = true;  // until a run ends before it meets its fault
  for (std::int64_t k = 1; met; ++k) {
    if (!isTurnOf(turn, k)) continue;
    ++tried;
    SCOPED_TRACE(std::string(name) + " at call " + std::to_string(k));
    const Outcome outcome = failCall(k, fault, error, frames);
    calls = outcome.calls;
    met = calls >= k;
    failed += outcome.failures > 0 ? 1 : 0;
    if (::testing::Test::HasFailure()) return;
  }
  std::printf("%s: %lld of the %lld calls of a run of %d frames failed once, %lld runs noticed\n",
              name, static_cast<long long>(tried), static_cast<long long>(calls), frames,
              static_cast<long long>(failed));
  if (fault == Fault::kShortWrite)
    EXPECT_EQ(failed, 0) << "a short write is no failure";
  else
    EXPECT_GT(failed, tried / 3);
}

TEST(EveryCall, MayFailWithAnInputOutputError) { failEveryCall(0, Fault::kError, EIO, "EIO"); }
TEST(EveryCall, MayFailOnAFullDisk) { failEveryCall(1, Fault::kError, ENOSPC, "ENOSPC"); }
// FileOps retries EINTR; one that breaks that promise is a disk that fails.
TEST(EveryCall, MayFailInterrupted) { failEveryCall(2, Fault::kError, EINTR, "EINTR"); }
TEST(EveryCall, MayWriteShort) { failEveryCall(3, Fault::kShortWrite, 0, "short write"); }

}  // namespace
}  // namespace patina::db::testing
