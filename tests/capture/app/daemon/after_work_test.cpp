// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/after_work.h"

#include <gmock/gmock.h>

#include <map>

#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

// What became of each run, waited for without a clock.
class Outcomes {
 public:
  std::function<void(const std::string&, const std::string&)> taker() {
    return [this](const std::string& run, const std::string& trouble) {
      const std::lock_guard lock(mutex_);
      outcomes_[run].push_back(trouble);
      changed_.notify_all();
    };
  }
  std::vector<std::string> of(const std::string& run) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return outcomes_.contains(run); });
    return outcomes_[run];
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::vector<std::string>> outcomes_;
};

TEST(AfterWork, RunsTheCommandWithTheRunBehindIt) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  Outcomes outcomes;
  AfterWork work({"/bin/sh", "-c", "echo made >> " + (folder / "").string() + "$0"},
                 outcomes.taker());
  work.add("one");
  work.add("two");
  EXPECT_THAT(outcomes.of("two"), ::testing::ElementsAre(""));
  EXPECT_EQ(testing::readFile(folder / "one"), "made\n");
}

TEST(AfterWork, SaysHowItFailed) {
  Outcomes outcomes;
  AfterWork failing({"/bin/sh", "-c", "exit 74"}, outcomes.taker());
  failing.add("exit");
  EXPECT_THAT(outcomes.of("exit"), ::testing::ElementsAre("exit 74"));
  AfterWork killed({"/bin/sh", "-c", "kill -9 $$"}, outcomes.taker());
  killed.add("signal");
  EXPECT_THAT(outcomes.of("signal"), ::testing::ElementsAre("ended by signal 9"));
  AfterWork absent({"/no/such/program"}, outcomes.taker());
  absent.add("absent");
  EXPECT_THAT(outcomes.of("absent")[0], ::testing::HasSubstr("/no/such/program"));
}

TEST(AfterWork, EndsTheProcessAtWorkWhenItEnds) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  Outcomes outcomes;
  {
    AfterWork work({"/bin/sh", "-c", "exec sleep 1000"}, outcomes.taker());
    work.add("long");
    work.add("never");
    EXPECT_EQ(work.waiting(), 2u);
  }  // would last a quarter of an hour
}

}  // namespace
}  // namespace patina::daemon
