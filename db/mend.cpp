// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/mend.h"

#include <string>
#include <utility>
#include <vector>

namespace patina::db {
namespace {

constexpr const char* kParents = R"sql(
INSERT INTO run(id, specimen_id, rig_id, plan_toml, plan_sha256, rig_toml, boot_id, t0_utc_ns,
  t0_boot_ns, seed, state, interval_ns, duration_ns, number)
  SELECT run_id, (SELECT coalesce(max(id), 0) + 1 FROM specimen),
    (SELECT coalesce(max(id), 0) + 1 FROM rig), '', '', '', '', min(due_utc_ns), 0, 0, 'recovered',
    0, max(due_utc_ns) - min(due_utc_ns),
    (SELECT coalesce(max(number), 0) FROM run) + row_number() OVER (ORDER BY run_id)
  FROM step WHERE run_id NOT IN (SELECT id FROM run) GROUP BY run_id;
INSERT INTO specimen SELECT DISTINCT specimen_id, 'unknown-' || specimen_id, '', '', ''
  FROM run WHERE specimen_id NOT IN (SELECT id FROM specimen);
INSERT INTO rig SELECT DISTINCT rig_id, 'unknown', 'unknown-' || rig_id, ''
  FROM run WHERE rig_id NOT IN (SELECT id FROM rig);
INSERT INTO device SELECT DISTINCT device_id, 'camera', '', '', ''
  FROM shot WHERE device_id NOT IN (SELECT id FROM device);
INSERT INTO device SELECT DISTINCT device_id, 'sensor', '', '', ''
  FROM reading WHERE device_id NOT IN (SELECT id FROM device);
DELETE FROM frame_calibration WHERE frame_id NOT IN (SELECT id FROM frame)
  OR calibration_id NOT IN (SELECT id FROM calibration);
DELETE FROM product_input WHERE product_id NOT IN (SELECT id FROM product);
)sql";

}  // namespace

void mendReferences(Database& catalogue) {
  // Each round removes what referred to what the round before removed.
  for (;;) {
    catalogue.run(kParents);
    std::vector<std::pair<std::string, std::int64_t>> broken;
    {
      Statement check(catalogue, "PRAGMA foreign_key_check");
      while (check.step())
        if (!check.isNull(1)) broken.emplace_back(check.text(0), check.integer(1));
    }
    if (broken.empty()) return;
    for (const auto& [table, row] : broken) {
      Statement gone(catalogue, "DELETE FROM " + table + " WHERE rowid = ?");
      gone.bind(1, row).run();
    }
  }
}

}  // namespace patina::db
