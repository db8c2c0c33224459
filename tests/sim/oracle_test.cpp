// SPDX-License-Identifier: GPL-3.0-or-later
// The oracle must be able to condemn: what bugs would leave behind is planted in the archive of a
// week that was fine, and each is called by its name.
#include "tests/sim/oracle.h"

#include <gmock/gmock.h>

#include "db/database.h"
#include "tests/sim/week.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A week of several light states with a quiet end.
constexpr std::uint64_t kSeed = 3;

struct PlantedBug {
  const char* name;
  const char* sql;
  const char* verdict;
};

class PlantedBugs : public ::testing::TestWithParam<PlantedBug> {};

TEST_P(PlantedBugs, IsCalledByItsName) {
  const auto plant = [](const std::filesystem::path& archive) {
    db::Database catalogue(archive / "catalog.sqlite", db::Database::Access::kWrite,
                           db::realFileOps());
    catalogue.run("PRAGMA foreign_keys=OFF");
    catalogue.run(GetParam().sql);
  };
  EXPECT_THAT(runWeek(kSeed, plant).problems, Contains(HasSubstr(GetParam().verdict)));
}

#define PATINA_CAPTURED "(SELECT max(id) FROM shot WHERE state = 'captured')"
INSTANTIATE_TEST_SUITE_P(
    Each, PlantedBugs,
    ::testing::Values(
        PlantedBug{"a_lost_frame", "DELETE FROM frame WHERE id = (SELECT max(id) FROM frame)",
                   "acknowledged and lost"},
        PlantedBug{"a_shot_in_an_earlier_step",
                   "UPDATE shot SET step_id = step_id - 1, attempt = 90 WHERE id "
                   "= " PATINA_CAPTURED,
                   "holds a picture younger than one of"},
        PlantedBug{"a_shot_in_a_later_step",
                   "UPDATE shot SET step_id = (SELECT max(id) FROM step), attempt = 90 WHERE id = "
                   "(SELECT min(id) FROM shot WHERE state = 'captured')",
                   "holds a picture of"},
        PlantedBug{"another_light",
                   "UPDATE shot SET light_state = 'x+y' WHERE id = " PATINA_CAPTURED,
                   "holds a picture of"},
        PlantedBug{"another_camera",
                   "INSERT INTO device VALUES('cam9', 'camera', '', '', '');"
                   "UPDATE shot SET device_id = 'cam9' WHERE id = " PATINA_CAPTURED,
                   "holds a picture of"},
        PlantedBug{"another_exposure",
                   "UPDATE shot SET exposure_ns = 1 WHERE id = " PATINA_CAPTURED,
                   "holds a picture of"},
        PlantedBug{"a_step_without_a_row",
                   "DELETE FROM step WHERE number = (SELECT max(number) FROM step)",
                   "was due and has 0 rows"},
        PlantedBug{"a_step_called_failed",
                   "UPDATE step SET decision = 'failed' WHERE number = (SELECT max(number) FROM "
                   "step)",
                   "all is well, but step"},
        PlantedBug{"a_step_never_decided",
                   "UPDATE step SET decision = 'pending' WHERE number = (SELECT max(number) FROM "
                   "step)",
                   "was never decided"},
        PlantedBug{"a_step_beyond_the_plan",
                   "UPDATE step SET number = 9999 WHERE number = (SELECT max(number) FROM step)",
                   "is beyond the plan"}),
    [](const auto& bug) { return std::string(bug.param.name); });
#undef PATINA_CAPTURED

TEST(Oracle, SeesOtherBytesUnderTheNameOfAFrame) {
  const auto plant = [](const std::filesystem::path& archive) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(archive / "frames"))
      if (entry.is_regular_file()) {
        std::string bytes = readFile(entry.path());
        bytes[bytes.size() / 2] ^= 1;
        writeFile(entry.path(), bytes);
        return;
      }
  };
  EXPECT_THAT(runWeek(kSeed, plant).problems, Contains(HasSubstr("verify: hash")));
}

TEST(Oracle, HasNothingAgainstTheWeekAsItWas) { EXPECT_THAT(runWeek(kSeed).problems, IsEmpty()); }

}  // namespace
}  // namespace patina::testing
