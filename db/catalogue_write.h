// SPDX-License-Identifier: GPL-3.0-or-later
// Rows into the catalogue. Statements are prepared at first use and kept. Internal to db/.
#pragma once

#include <map>
#include <string>
#include <tuple>

#include "db/database.h"
#include "db/journal.h"
#include "db/row_statements.h"

namespace patina::db {

// Call inside a Transaction. Thread-bound, like its database.
class CatalogueWriter {
 public:
  explicit CatalogueWriter(Database& database);

  template <class Row>
  void insert(const Row& row) {
    auto& statement = std::get<Prepared<Row>>(prepared_).insert;
    if (!statement) statement = Statement(database_, insertSql<Row>());
    runWith(statement, row);
  }
  // A row of the journal: new, or the same again with newer columns.
  template <class Row>
  void upsert(const Row& row) {
    auto& statement = std::get<Prepared<Row>>(prepared_).upsert;
    if (!statement) statement = Statement(database_, upsertSql<Row>());
    runWith(statement, row);
  }
  void replay(const AnyRow& row);

  // An armed shot gets its outcome; throws ArchiveError(kBadData) when no such shot is armed, so
  // that nothing is acknowledged twice.
  void settleShot(const ShotRow& shot);
  void finishStep(const StepRow& step);
  void dropInputs(const std::string& product_id);

  void mark(const std::string& journal, std::int64_t bytes);
  std::int64_t markOf(const std::string& journal);
  RowId nextId(const char* table);    // largest + 1; a visitor counts below 0
  RowId lowestId(const char* table);  // 0 when no visitor has left a row

 private:
  template <class Row>
  struct Prepared {
    Statement insert, upsert;
  };
  template <class Variant>
  struct PreparedFor;
  template <class... Rows>
  struct PreparedFor<std::variant<Rows...>> {
    using Type = std::tuple<Prepared<Rows>...>;
  };
  Database& database_;
  PreparedFor<AnyRow>::Type prepared_;
  Statement settle_shot_, finish_step_, drop_inputs_, mark_, mark_of_;
};

}  // namespace patina::db
