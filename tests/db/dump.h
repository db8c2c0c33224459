// SPDX-License-Identifier: GPL-3.0-or-later
// Every table of a catalogue as text, one line a row.
#pragma once

#include <string>
#include <vector>

#include "db/database.h"

namespace patina::db::testing {

inline std::vector<std::string> dumpOf(const std::filesystem::path& archive) {
  Database database(archive / "catalog.sqlite", Database::Access::kWrite, realFileOps());
  std::vector<std::string> selects, lines;
  Statement tables(database,
                   "SELECT 'SELECT ''' || t.name || ''' || ' || group_concat('''|'' || quote(' || "
                   "c.name || ')', ' || ') || ' FROM ' || t.name || ' ORDER BY 1' FROM "
                   "sqlite_schema t JOIN pragma_table_info(t.name) c WHERE t.type = 'table' "
                   "GROUP BY t.name ORDER BY t.name");
  while (tables.step()) selects.emplace_back(tables.text(0));
  for (const auto& sql : selects) {
    Statement rows(database, sql);
    while (rows.step()) lines.emplace_back(rows.text(0));
  }
  return lines;
}

}  // namespace patina::db::testing
