// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of the journal: one flat JSON object a row,
//   {"row":"frame","id":7,...,"crc32":"89abcdef"}
// whose CRC-32 (the one of zlib) covers all that stands before its own member. The last line of a
// transaction also says "commit":true: lines without one behind them were never promised.
// Internal to db/.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "db/cells.h"

namespace patina::db {

std::uint32_t crc32(std::string_view data);
// The text itself, or a copy in which bytes that are no UTF-8 have become U+FFFD: table and journal
// must hold the same, and JSON holds nothing else.
std::string_view validText(std::string_view text, std::string& copy);

// The lines of one transaction.
class JournalLines {
 public:
  template <class Row>
  void add(const Row& row) {
    begin(Table<Row>::kName);
    columns(*this, row);
  }
  // Seals the last line. No more rows may be added.
  const std::string& finish();
  bool empty() const { return text_.empty(); }

  template <class T>
  void operator()(const char* column, const T& field) {
    text_ += ",\"";
    text_ += column;
    text_ += "\":";
    put(*this, field);
  }
  void null() { text_ += "null"; }
  void integer(std::int64_t v);
  void real(double v);  // shortest form that reads back the same; NaN is null, infinities are text
  void text(std::string_view v);

 private:
  void begin(const char* table);
  void seal();
  std::string text_;
  std::size_t line_ = 0;
  bool open_ = false, finished_ = false;
};

}  // namespace patina::db
