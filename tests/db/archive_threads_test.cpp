// SPDX-License-Identifier: GPL-3.0-or-later
// One archive, several sessions: what its contract promises, for ThreadSanitizer to look at too.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "db/archive_pages.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::IsEmpty;

std::string runNumber(int n) { return "run-" + std::to_string(n); }

TEST(ArchiveThreads, SeveralSessionsLoseAndMixNothing) {
  constexpr int kRuns = 4, kSteps = 25;
  const TempFolder folder = TempFolder::inMemory();
  Archive archive(optionsFor(folder / "a"));
  for (int n = 0; n < kRuns; ++n) beginRun(archive, runNumber(n));
  std::vector<std::set<std::string>> acked(kRuns);
  std::vector<std::thread> sessions;
  for (int n = 0; n < kRuns; ++n)
    sessions.emplace_back([&, n] {
      const std::string run = runNumber(n);
      for (int number = 0; number < kSteps; ++number) {
        // Every third picture is the same in all runs: one file, a row each.
        const auto seed = static_cast<std::uint64_t>(number % 3 == 0 ? number : 1000 * n + number);
        for (const FrameRow& frame : capture(archive, number, seed, run))
          acked[static_cast<std::size_t>(n)].insert(frame.sha256.hex());
        archive.addEvent({0, run, at(number), "alarm", run});
        archive.reader().step(run, number);
      }
      archive.setRunState(run, "finished");
    });
  // As HTTP does: readers of their own, while all that goes on.
  std::thread onlooker([&] {
    for (int i = 0; i < 50; ++i) {
      const ArchiveReader reader(folder / "a");
      EXPECT_EQ(reader.runs().size(), std::size_t{kRuns});
      ArchivePages(reader).frames(runNumber(i % kRuns), {-1, 100});
    }
  });
  for (auto& session : sessions) session.join();
  onlooker.join();
  for (int n = 0; n < kRuns; ++n) {
    const auto& reader = archive.reader();
    EXPECT_EQ(reader.steps(runNumber(n), Decision::kCaptured).size(), std::size_t{kSteps});
    std::set<std::string> found;
    reader.eachFrame(runNumber(n), [&](const ArchiveReader::CapturedFrame& one) {
      found.insert(one.frame.sha256.hex());
      EXPECT_EQ(one.step.run_id, runNumber(n));
    });
    EXPECT_EQ(found, acked[static_cast<std::size_t>(n)]);
    for (const EventRow& event : reader.events(runNumber(n))) EXPECT_EQ(event.detail, runNumber(n));
  }
  Progress progress;
  EXPECT_THAT(verify(folder / "a", progress).problems, IsEmpty());
}

TEST(ArchiveThreads, AnotherRunGoesOnWhileALargePictureIsWritten) {
  const TempFolder folder = TempFolder::inMemory();
  Archive* opened = nullptr;
  bool went_on = false, during = false;
  HookedDisk disk([&](Call call, const std::filesystem::path& path) {
    // In the middle of the first picture's bytes the other run commits, on a thread of its own.
    if (call == Call::kWrite && path.parent_path().filename() == "tmp" && during &&
        path.extension() == ".jpg") {
      during = false;
      std::thread([&] {
        opened->addEvent({0, runNumber(1), at(0), "alarm", "meanwhile"});
        went_on = true;
      }).join();
    }
    return 0;
  });
  Archive archive(optionsFor(folder / "a", &disk));
  opened = &archive;
  for (int n = 0; n < 2; ++n) beginRun(archive, runNumber(n));
  during = true;
  capture(archive, 0, 1, runNumber(0));
  EXPECT_TRUE(went_on);
}

TEST(ArchiveThreads, AStateIsChangedOnlyFromWhereItWas) {
  const TempFolder folder = TempFolder::inMemory();
  Archive archive(optionsFor(folder / "a"));
  beginRun(archive);
  EXPECT_TRUE(archive.changeRunState(kRunId, {"running"}, "paused"));
  EXPECT_FALSE(archive.changeRunState(kRunId, {"running", "stopped"}, "finished"));
  EXPECT_EQ(archive.reader().findRun(kRunId).state, "paused");
  EXPECT_THROW(archive.changeRunState("nobody", {"running"}, "paused"), ArchiveError);
}

TEST(ArchiveThreads, ARunThatEndedKeepsNoFileOpen) {
  const TempFolder folder = TempFolder::inMemory();
  Archive archive(optionsFor(folder / "a"));
  const auto descriptors = [] {
    std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  std::ptrdiff_t after_one = 0;
  for (int n = 0; n < 20; ++n) {
    beginRun(archive, runNumber(n));
    capture(archive, 0, static_cast<std::uint64_t>(n), runNumber(n));
    archive.setRunState(runNumber(n), "finished");
    if (n == 0) after_one = descriptors();
  }
  EXPECT_EQ(descriptors(), after_one);
}

}  // namespace
}  // namespace patina::db::testing
