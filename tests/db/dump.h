// SPDX-License-Identifier: GPL-3.0-or-later
// Every table of a catalogue as text, one line a row.
#pragma once

#include <sqlite3.h>

#include <string>
#include <vector>

#include "db/database.h"

namespace patina::db::testing {

inline std::vector<std::string> dumpOf(const std::filesystem::path& archive) {
  Database database(archive / "catalog.sqlite", Database::Access::kWrite, realFileOps());
  std::vector<std::string> tables, lines;
  {
    Statement names(database, "SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name");
    while (names.step()) tables.emplace_back(names.text(0));
  }
  for (const auto& table : tables) {
    sqlite3_stmt* rows = nullptr;
    const std::string sql = "SELECT * FROM " + table + " ORDER BY 1, 2";
    sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &rows, nullptr);
    while (sqlite3_step(rows) == SQLITE_ROW) {
      std::string line = table;
      for (int column = 0; column < sqlite3_column_count(rows); ++column) {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(rows, column));
        line += "|" + (text ? std::string(text) : "NULL");
      }
      lines.push_back(line);
    }
    sqlite3_finalize(rows);
  }
  return lines;
}

}  // namespace patina::db::testing
