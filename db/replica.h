// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue made from the journals alone. Internal to db/.
#pragma once

#include <functional>
#include <string>

#include "db/catalogue_write.h"
#include "db/database.h"

namespace patina::db {

struct Replayed {
  std::int64_t rows = 0, frames = 0, end = 0;  // end: behind the last whole transaction
  int bad_lines = 0;
};
// All transactions of a journal up to `to`, row by row, into `writer`'s tables. The last one is
// left out when `accept_last` says so. Streamed; call inside a transaction.
Replayed replayJournal(FileOps& files, const std::filesystem::path& journal, std::int64_t to,
                       CatalogueWriter& writer,
                       const std::function<bool(const JournalBatch&)>& accept_last);

// Holds what the journals say beside the real catalogue, at one moment of it, to compare the two.
class Replica {
 public:
  explicit Replica(const std::filesystem::path& archive);
  ~Replica();

  struct Difference {
    std::string table, key, detail;
  };
  using Report = std::function<void(const Difference&)>;
  // Journals against their files and marks: table is "journal", key the path.
  void replayAll(const Report& report, const std::function<void()>& each_journal);
  void compare(const Report& report);
  std::int64_t rows() const { return rows_; }
  std::int64_t journals();

 private:
  std::filesystem::path archive_;
  Database database_;
  std::unique_ptr<CatalogueWriter> writer_;
  std::int64_t rows_ = 0;
};

}  // namespace patina::db
