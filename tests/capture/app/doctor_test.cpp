// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <set>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

class Doctor : public Rehearsed {
 protected:
  static std::set<std::string> subjects(const JsonAnswer& told) {
    std::set<std::string> found;
    for (std::size_t i = 0; i < told.size("/items"); ++i) {
      const std::string at = "/items/" + std::to_string(i);
      found.insert(told.text(at + "/subject"));
      EXPECT_THAT((std::vector<std::string>{"ok", "warn", "fail"}),
                  ::testing::Contains(told.text(at + "/level")));
      EXPECT_EQ(told.text(at + "/level") == "ok", told.text(at + "/do").empty()) << at;
    }
    return found;
  }
};

TEST_F(Doctor, LooksAtMachineAndArchiveAndLeavesNothing) {
  const Finished finished = patina({"doctor", "--json"});
  EXPECT_THAT(subjects(JsonAnswer(finished.out)),
              IsSupersetOf({"clock", "suspend", "memory", "descriptors", "file system",
                            "permissions", "lock", "disk space", "disk speed"}));
  for (const auto& entry : std::filesystem::directory_iterator(archive()))
    EXPECT_THAT(entry.path().string(), ::testing::Not(HasSubstr("doctor")));
}

TEST_F(Doctor, ExitsWithConfigurationWhenSomethingWouldSpoilTheRun) {
  const Finished finished =
      runPatina({"doctor", "--archive", "/proc/patina-archive"}, {"PATINA_ARCHIVE="});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.out, HasSubstr("fail"));
}

TEST_F(Doctor, WithoutAnArchiveJudgesTheMachineAlone) {
  const Finished finished = runPatina({"doctor", "--json"}, {"PATINA_ARCHIVE="});
  EXPECT_FALSE(subjects(JsonAnswer(finished.out)).contains("disk speed"));
}

}  // namespace
}  // namespace patina::testing
