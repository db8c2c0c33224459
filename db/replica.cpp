// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/replica.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "db/schema.h"

namespace patina::db {
namespace {

template <class Row>
void compareTable(Database& database, const Replica::Report& report) {
  const std::string table = Table<Row>::kName;
  const std::string list = columnList<Row>();
  const auto except = [&](const std::string& has, const std::string& lacks) {
    return "SELECT " + list + " FROM " + has + "." + table + " EXCEPT SELECT " + list + " FROM " +
           lacks + "." + table;
  };
  const auto ask = [&](const std::string& sql, const std::string& detail) {
    Statement statement(database, sql);
    while (statement.step()) {
      std::string key(statement.text(0));
      if (Table<Row>::kKeys == 2) key += ", " + std::string(statement.text(1));
      report({table, key, detail});
    }
  };
  ask(except("main", "catalogue"), "the journal has this row; the catalogue has not, or another");
  ask(except("catalogue", "main"), "the catalogue has this row; the journal has not, or another");
}

template <class... Rows>
void compareTables(Database& database, const Replica::Report& report,
                   const std::variant<Rows...>* /*type*/) {
  (compareTable<Rows>(database, report), ...);
}

}  // namespace

Replayed replayJournal(FileOps& files, const std::filesystem::path& journal, std::int64_t to,
                       CatalogueWriter& writer,
                       const std::function<bool(const JournalBatch&)>& accept_last) {
  Replayed done;
  std::optional<JournalBatch> waiting;
  const auto take = [&](const JournalBatch& batch) {
    for (const AnyRow& row : batch.rows) {
      writer.replay(row);
      if (std::holds_alternative<FrameRecord>(row)) ++done.frames;
    }
    done.rows += static_cast<std::int64_t>(batch.rows.size());
    done.bad_lines += batch.bad_lines;
    done.end = batch.end;
  };
  scanJournal(files, journal, 0, to, [&](JournalBatch&& batch) {
    if (waiting) take(*waiting);
    waiting = std::move(batch);
  });
  if (waiting && (!accept_last || accept_last(*waiting))) take(*waiting);
  return done;
}

Replica::Replica(const std::filesystem::path& archive)
    : archive_(archive), database_(Database::Scratch{}) {
  createTables(database_);
  database_.attach(archive / "catalog.sqlite", "catalogue");
  writer_ = std::make_unique<CatalogueWriter>(database_);
  database_.run("BEGIN");
}

Replica::~Replica() = default;

std::int64_t Replica::journals() {
  return database_.number("SELECT count(*) FROM catalogue.journal_mark");
}

void Replica::replayAll(const Report& report, const std::function<void()>& each_journal) {
  std::map<std::string, std::int64_t> marks;
  {
    Statement statement(database_, "SELECT journal, bytes FROM catalogue.journal_mark");
    while (statement.step()) marks.emplace(statement.text(0), statement.integer(1));
  }
  for (const auto& [name, mark] : marks) {
    const auto path = journalPath(archive_, name);
    const auto problem = [&](const std::string& detail) {
      report({"journal", path.string(), detail});
    };
    std::error_code error;
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
    if (error) {
      problem("is not there");
    } else {
      if (size < mark)
        problem("has " + std::to_string(size) + " bytes; the catalogue contains " +
                std::to_string(mark) + " of it");
      const Replayed done = replayJournal(realFileOps(), path, mark, *writer_, {});
      if (done.bad_lines > 0) problem(std::to_string(done.bad_lines) + " lines are damaged");
      if (done.end < std::min(mark, size)) problem("ends within a transaction");
      rows_ += done.rows;
    }
    each_journal();
  }
}

void Replica::compare(const Report& report) {
  compareTables(database_, report, static_cast<const AnyRow*>(nullptr));
}

}  // namespace patina::db
