// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue with very many frames, filled by SQL alone: no journal, no files.
#pragma once

#include <string>

#include "db/database.h"
#include "tests/db/small_run.h"

namespace patina::db::testing {

// `frames` steps of one shot and one frame, in an archive that exists and has the run. Every
// hundredth step was missed and has neither.
inline void fillCatalogue(const std::filesystem::path& archive, std::int64_t frames) {
  Database database(archive / "catalog.sqlite", Database::Access::kWrite, realFileOps());
  database.run("PRAGMA synchronous=OFF; PRAGMA cache_size=-262144; PRAGMA foreign_keys=OFF");
  const std::string count = std::to_string(frames);
  const std::string numbers =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n "
      "WHERE i < " +
      count + ") INSERT INTO ";
  const std::string utc = "(" + std::to_string(toNs(at(0))) + " + i * 5000000000)";
  Transaction transaction(database);
  database.run("INSERT INTO device VALUES('cam0', 'camera', '', '', '')");
  database.run(numbers + "step SELECT i, '" + kRunId + "', i, " + utc +
               ", iif(i % 100, 'captured', iif(i % 10000, 'missed', 'held')), '', 0, 0, 0, 1, "
               "iif(i % 100, 1, 0) FROM n");
  database.run(numbers + "shot SELECT i, i, 'cam0', 'key', 0, 0, 20000000, 100.0, 8.0, " + utc +
               ", i, 'captured' FROM n WHERE i % 100");
  // Multiplication by an odd number modulo 2^62 spreads the names as hashes are spread.
  database.run(numbers + "frame SELECT i, '" + kRunId +
               "', i, 0, printf('%016x%048x', (i * 2654435761 * 1597334677) & 0x3fffffffffffffff, "
               "i), 'jpg', 3000, 64, 48, " +
               utc + ", i, " + utc + ", 0.0, 1 FROM n WHERE i % 100");
  transaction.commit();
}

}  // namespace patina::db::testing
