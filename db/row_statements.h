// SPDX-License-Identifier: GPL-3.0-or-later
// Rows to and from prepared statements, by the lists of columns.h. Internal to db/.
#pragma once

#include <string>

#include "db/cells.h"
#include "db/database.h"
#include "db/journal_lines.h"

namespace patina::db {

// Binds a row's columns from index `first` on.
class RowBinder {
 public:
  explicit RowBinder(Statement& statement, int first = 1) : statement_(statement), next_(first) {}
  template <class T>
  void operator()(const char* /*name*/, const T& field) {
    put(*this, field);
  }
  void null() { statement_.bindNull(next_++); }
  void integer(std::int64_t v) { statement_.bind(next_++, v); }
  void real(double v) { statement_.bind(next_++, v); }
  void text(std::string_view v) {
    std::string copy;
    statement_.bind(next_++, validText(v, copy));
  }

 private:
  Statement& statement_;
  int next_;
};

// Reads a row's columns from column `first` on.
class RowReader {
 public:
  explicit RowReader(const Statement& statement, int first = 0)
      : statement_(statement), next_(first) {}
  template <class T>
  void operator()(const char* /*name*/, T&& field) {
    get(*this, field);
    ++next_;
  }
  bool isNull() const { return statement_.isNull(next_); }
  std::int64_t integer() const { return statement_.integer(next_); }
  double real() const { return statement_.real(next_); }
  std::string_view text() const { return statement_.text(next_); }
  int next() const { return next_; }

 private:
  const Statement& statement_;
  int next_;
};

// "id, run_id, ...", each with `before` in front ("frame.").
template <class Row>
std::string columnList(const std::string& before = {}) {
  std::string list;
  const Row row{};
  columns(
      [&](const char* column, const auto&) {
        if (!list.empty()) list += ", ";
        list += before + column;
      },
      row);
  return list;
}

template <class Row>
std::string insertSql() {
  std::string marks;
  const Row row{};
  columns([&](const char*, const auto&) { marks += marks.empty() ? "?" : ", ?"; }, row);
  return std::string("INSERT INTO ") + Table<Row>::kName + "(" + columnList<Row>() + ") VALUES(" +
         marks + ")";
}

// Inserts, or sets every column of the row that has the key.
template <class Row>
std::string upsertSql() {
  std::string keys, sets;
  int index = 0;
  const Row row{};
  columns(
      [&](const char* column, const auto&) {
        if (index++ < Table<Row>::kKeys)
          keys += (keys.empty() ? "" : ", ") + std::string(column);
        else
          sets += (sets.empty() ? "" : ", ") + std::string(column) + " = excluded." + column;
      },
      row);
  return insertSql<Row>() + " ON CONFLICT(" + keys + ") DO UPDATE SET " + sets;
}

template <class Row>
void runWith(Statement& statement, const Row& row) {
  RowBinder binder(statement);
  columns(binder, row);
  statement.run();
}

template <class Row>
Row readRow(const Statement& statement, int first = 0) {
  Row row{};
  RowReader reader(statement, first);
  columns(reader, row);
  return row;
}

}  // namespace patina::db
