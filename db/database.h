// SPDX-License-Identifier: GPL-3.0-or-later
// SQLite connections and prepared statements that clean up after themselves. Internal to db/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "db/file_ops.h"
#include "db/sqlite_vfs.h"

struct sqlite3;
struct sqlite3_stmt;

namespace patina::db {

class Statement;

// One connection, thread-bound. SQLite's errors become ArchiveError.
class Database {
 public:
  enum class Access { kRead, kReadImmutable /* nobody writes it */, kWrite, kCreate };
  Database(const std::filesystem::path& file, Access access, FileOps& files);
  struct Scratch {};
  explicit Database(Scratch);  // private, spills to disk, gone with the object
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Another database beside this one, read-only, under a name of its own.
  void attach(const std::filesystem::path& file, const std::string& as);
  void run(const std::string& sql);  // any number of statements, no rows
  std::int64_t number(const std::string& sql);
  int changes() const;
  void gatherWrites(bool gather);  // see SqliteVfs
  const std::filesystem::path& file() const { return file_; }
  sqlite3* handle() const { return handle_; }
  [[noreturn]] void fail(int code, const std::string& doing);

 private:
  std::filesystem::path file_;
  friend class Transaction;
  std::unique_ptr<SqliteVfs> vfs_;
  sqlite3* handle_ = nullptr;
  sqlite3_stmt *begin_ = nullptr, *commit_ = nullptr;  // prepared by the first Transaction
};

// Prepared once, run often. Text is copied.
class Statement {
 public:
  Statement() = default;
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&& other) noexcept;

  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, double value);  // NaN is stored as NULL
  Statement& bind(int index, std::string_view value);
  Statement& bindNull(int index);

  bool step();  // true: a row stands ready
  void run();   // to its end, and reset
  void reset();

  std::int64_t integer(int column) const;
  double real(int column) const;  // NULL reads as NaN
  std::string_view text(int column) const;
  bool isNull(int column) const;
  const char* sql() const;
  explicit operator bool() const { return statement_ != nullptr; }

 private:
  Database* database_ = nullptr;
  sqlite3_stmt* statement_ = nullptr;
};

// Resets a statement when the rows it is read for go out of scope.
class Reading {
 public:
  explicit Reading(Statement& statement) : statement_(statement) {}
  ~Reading() { statement_.reset(); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  Statement& statement_;
};

// BEGIN IMMEDIATE now; rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  void runPrepared(const char* sql, sqlite3_stmt*& statement);
  Database& database_;
  bool open_ = true;
};

}  // namespace patina::db
