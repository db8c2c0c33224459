// SPDX-License-Identifier: GPL-3.0-or-later
// A run with very many frames behind it, killed: the next process captures again within 10 s.
// PATINA_FRAMES is how many, 20,000 unless set.
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>

#include "db/archive.h"
#include "db/database.h"
#include "tests/support/places.h"
#include "tests/system/kill_driver.h"

namespace patina::testing {
namespace {

using ::testing::IsEmpty;

std::int64_t framesAskedFor() {
  const char* text = std::getenv("PATINA_FRAMES");
  return text != nullptr ? std::atoll(text) : 20'000;
}

// As many steps of one frame each, behind those of the run that is there. Rows only: nobody opens
// an old frame to go on, and the files are marked missing.
void addFrames(const std::filesystem::path& archive, std::int64_t frames) {
  {
    db::ArchiveOptions options;
    options.folder = archive;
    const db::Archive recovered(options);  // a step may be in the journal alone
  }
  db::Database database(archive / "catalog.sqlite", db::Database::Access::kWrite,
                        db::realFileOps());
  database.run("PRAGMA synchronous=OFF; PRAGMA foreign_keys=OFF; PRAGMA cache_size=-262144");
  const std::int64_t last = database.number("SELECT max(number) FROM step");
  const std::string numbers = "WITH RECURSIVE n(i) AS (SELECT " + std::to_string(last + 1) +
                              " UNION ALL SELECT i + 1 FROM n WHERE i < " +
                              std::to_string(last + frames) + ") INSERT INTO ";
  const std::string id = "i + 10000000", run = "(SELECT id FROM run)",
                    utc = "(SELECT t0_utc_ns FROM run) + i * 50000000";
  db::Transaction transaction(database);
  database.run(numbers + "step SELECT " + id + ", " + run + ", i, " + utc +
               ", 'captured', '', 0, 0, 0, 1, 1 FROM n");
  database.run(numbers + "shot SELECT " + id + ", " + id +
               ", 'cam0', 'key', 0, 0, 10000000, 100.0, 8.0, " + utc + ", i, 'captured' FROM n");
  database.run(numbers + "frame SELECT " + id + ", " + run + ", " + id +
               ", 0, printf('%064x', i), 'jpg', 3000, 64, 48, " + utc + ", i, " + utc +
               ", 0.0, 1 FROM n");
  transaction.commit();
}

TEST(ManyFrames, AreNoReasonToStartSlowlyAfterAKill) {
  KillDriver driver({{(programFolder() / "session_victim").string(), "--archive", "{archive}",
                      "--log-acks", "{acks}"},
                     {}},
                    1);
  // Rounds that kill after some acknowledgements and judge the archive as it lies there.
  ASSERT_THAT(driver.kill(1), IsEmpty());
  const std::size_t before = driver.acked();
  addFrames(driver.archive(), framesAskedFor());
  for (const int round : {5, 13, 17}) ASSERT_THAT(driver.kill(round), IsEmpty());
  std::printf("%lld frames in the catalogue: capturing again within %.2f s of the start\n",
              static_cast<long long>(framesAskedFor()),
              std::chrono::duration<double>(driver.slowestStart()).count());
  EXPECT_GT(driver.acked(), before);
  EXPECT_LT(driver.slowestStart(), std::chrono::seconds(10));
}

}  // namespace
}  // namespace patina::testing
