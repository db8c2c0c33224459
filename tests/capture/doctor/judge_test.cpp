// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/doctor/judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace patina::doctor {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

MachineFacts goodMachine() { return {true, {}, {}, 4ull << 30, 1024}; }

ArchiveFacts goodArchive() {
  ArchiveFacts facts;
  facts.there = facts.folder = "/data/ivy";
  facts.file_system = "ext4";
  facts.is_archive = true;
  facts.free_bytes = 500'000'000'000;
  facts.total_bytes = 1'000'000'000'000;
  facts.free_files = facts.total_files = 1'000'000;
  facts.commit_median = 12ms;
  facts.commit_worst = 80ms;
  return facts;
}

template <class Facts>
Finding of(const std::string& subject, const Facts& facts) {
  for (const Finding& finding : judge(facts))
    if (finding.subject == subject) return finding;
  return {subject, Level::kOk, "(nothing said)", ""};
}

TEST(Judge, FindsNothingWrongWithAGoodMachineAndArchive) {
  for (const auto& findings : {judge(goodMachine()), judge(goodArchive())})
    for (const Finding& f : findings) {
      EXPECT_EQ(f.level, Level::kOk) << f.subject << ": " << f.what;
      EXPECT_EQ(f.do_this, "");
    }
}

TEST(Judge, EachTroubleOfAMachineIsToldWithWhatToDo) {
  struct Case {
    std::function<void(MachineFacts&)> change;
    const char *subject, *advice;
    Level level;
  };
  for (const auto& [change, subject, advice, level] : std::vector<Case>{
           {[](auto& m) { m.clock_synchronised = false; }, "clock", "chrony", Level::kWarn},
           {[](auto& m) { m.clock_synchronised.reset(); }, "clock", "chrony", Level::kWarn},
           {[](auto& m) {
              m.sleep_states = {"freeze", "mem"};
              m.unmasked_sleep = {"suspend.target"};
            },
            "suspend", "systemctl mask suspend.target", Level::kWarn},
           {[](auto& m) { m.memory_free_bytes = 300 << 20; }, "memory", "limit", Level::kWarn},
           {[](auto& m) { m.memory_free_bytes = 100 << 20; }, "memory", "limit", Level::kFail},
           {[](auto& m) { m.descriptors = 256; }, "descriptors", "ulimit", Level::kWarn},
           {[](auto& m) { m.descriptors = 64; }, "descriptors", "ulimit", Level::kFail}}) {
    MachineFacts facts = goodMachine();
    change(facts);
    const Finding finding = of(subject, facts);
    EXPECT_EQ(finding.level, level) << subject;
    EXPECT_THAT(finding.do_this, HasSubstr(advice)) << subject;
  }
}

TEST(Judge, AMachineThatSleepsOnlyWhenAskedButIsMaskedIsFine) {
  MachineFacts facts = goodMachine();
  facts.sleep_states = {"mem"};
  EXPECT_EQ(of("suspend", facts).level, Level::kOk);
}

TEST(Judge, EachTroubleOfAnArchiveIsToldWithWhatToDo) {
  struct Case {
    std::function<void(ArchiveFacts&)> change;
    const char *subject, *advice;
    Level level;
  };
  for (const auto& [change, subject, advice, level] : std::vector<Case>{
           {[](auto& a) { a.refused = "a network file system"; }, "file system", "local disk",
            Level::kFail},
           {[](auto& a) { a.file_system = "tmpfs"; }, "file system", "disk", Level::kWarn},
           {[](auto& a) { a.file_system = "vfat"; }, "file system", "ext4", Level::kWarn},
           {[](auto& a) { a.read_only = true; }, "permissions", "remount", Level::kFail},
           {[](auto& a) { a.writable = false; }, "permissions", "chown", Level::kFail},
           {[](auto& a) { a.locked_by = "patina capture"; }, "lock", "another archive",
            Level::kWarn},
           {[](auto& a) { a.free_bytes = 90'000'000'000; }, "disk space", "plan check",
            Level::kWarn},
           {[](auto& a) { a.free_bytes = 9'000'000'000; }, "disk space", "plan check",
            Level::kFail},
           {[](auto& a) { a.free_files = 100; }, "disk files", "inodes", Level::kFail},
           {[](auto& a) { a.commit_median = 400ms; }, "disk speed", "faster", Level::kWarn},
           {[](auto& a) { a.commit_worst = 3s; }, "disk speed", "faster", Level::kWarn},
           {[](auto& a) { a.commit_median = 3s; }, "disk speed", "faster", Level::kFail},
           {[](auto& a) { a.probe_failed = "no rename"; }, "disk speed", "right", Level::kFail}}) {
    ArchiveFacts facts = goodArchive();
    change(facts);
    const Finding finding = of(subject, facts);
    EXPECT_EQ(finding.level, level) << subject;
    EXPECT_THAT(finding.do_this, HasSubstr(advice)) << subject;
  }
}

TEST(Judge, WhatIsNotKnownIsNotJudged) {
  ArchiveFacts facts = goodArchive();
  facts.free_bytes.reset();
  facts.commit_median.reset();
  for (const Finding& f : judge(facts)) {
    EXPECT_NE(f.subject, "disk space");
    EXPECT_NE(f.subject, "disk speed");
  }
}

}  // namespace
}  // namespace patina::doctor
