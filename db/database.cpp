// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/database.h"

#include <sqlite3.h>

#include <cctype>
#include <limits>
#include <utility>

#include "db/errors.h"

namespace patina::db {
namespace {

constexpr int kBusyMs = 5000;

int openFlags(Database::Access access) {
  constexpr int kPrivate = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE | SQLITE_OPEN_NOFOLLOW;
  switch (access) {
    case Database::Access::kRead:
      return kPrivate | SQLITE_OPEN_READONLY;
    case Database::Access::kReadImmutable:
      return kPrivate | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    case Database::Access::kWrite:
      return kPrivate | SQLITE_OPEN_READWRITE;
    case Database::Access::kCreate:
      break;
  }
  return kPrivate | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
}

Exit exitOf(int code) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Exit::kTemporary;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_CONSTRAINT:
    case SQLITE_SCHEMA:
      return Exit::kBadData;
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return Exit::kPermission;
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
      return Exit::kCannotCreate;
    case SQLITE_IOERR:
    case SQLITE_NOMEM:
      return Exit::kIo;
    default:
      return Exit::kBug;
  }
}

// "file:...?" with everything escaped that is not plainly a path.
std::string uriOf(const std::filesystem::path& file, const char* query) {
  std::string uri = "file:";
  for (const char c : file.string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '-' || c == '_') {
      uri += c;
    } else {
      uri += '%';
      uri += "0123456789ABCDEF"[byte >> 4];
      uri += "0123456789ABCDEF"[byte & 0xf];
    }
  }
  return uri + query;
}

}  // namespace

Database::Database(const std::filesystem::path& file, Access access, FileOps& files)
    : file_(file), vfs_(std::make_unique<SqliteVfs>(files)) {
  const std::string name =
      access == Access::kReadImmutable ? uriOf(file, "?immutable=1") : file.string();
  const int code = sqlite3_open_v2(name.c_str(), &handle_, openFlags(access), vfs_->name());
  if (code != SQLITE_OK) {
    sqlite3* broken = std::exchange(handle_, nullptr);
    sqlite3_close(broken);
    fail(code, "opening");
  }
  sqlite3_busy_timeout(handle_, kBusyMs);
}

Database::Database(Scratch) : file_("scratch") {
  const int code =
      sqlite3_open_v2("", &handle_, openFlags(Access::kCreate) | SQLITE_OPEN_URI, nullptr);
  if (code != SQLITE_OK) {
    sqlite3* broken = std::exchange(handle_, nullptr);
    sqlite3_close(broken);
    fail(code, "opening");
  }
  run("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF");
}

Database::~Database() {
  // Statements are gone by now: they are members declared after their database.
  sqlite3_finalize(begin_);
  sqlite3_finalize(commit_);
  sqlite3_close(handle_);
}

void Database::gatherWrites(bool gather) {
  if (vfs_) vfs_->gatherWrites(gather);
}

void Database::fail(int code, const std::string& doing) {
  const int error = vfs_ ? vfs_->takeError() : 0;
  const int primary = code & 0xff;
  const bool disk = primary == SQLITE_IOERR || primary == SQLITE_FULL || primary == SQLITE_CANTOPEN;
  if (disk && error != 0) throwDiskError(error, doing, file_);
  std::string what = doing + " " + file_.string() + ": ";
  what += handle_ ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  if (primary == SQLITE_FULL) throw DiskFull(what);
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB)
    what += "; 'patina archive rebuild' makes it anew from journal and frames";
  throw ArchiveError(exitOf(code), what);
}

void Database::attach(const std::filesystem::path& file, const std::string& as) {
  const auto attachAs = [&](const char* query) {
    Statement statement(*this, "ATTACH ? AS " + as);
    statement.bind(1, uriOf(file, query)).run();
    number("SELECT count(*) FROM " + as + ".sqlite_schema");
  };
  try {
    attachAs("?mode=ro");
  } catch (const ArchiveError& e) {
    if (e.exit() != Exit::kCannotCreate) throw;
    sqlite3_exec(handle_, ("DETACH " + as).c_str(), nullptr, nullptr, nullptr);
    attachAs("?immutable=1");  // a read-only medium
  }
}

void Database::run(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code, "writing");
}

std::int64_t Database::number(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

int Database::changes() const { return sqlite3_changes(handle_); }

Statement::Statement(Database& database, const std::string& sql) : database_(&database) {
  const int code = sqlite3_prepare_v3(database.handle(), sql.c_str(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement_, nullptr);
  if (code != SQLITE_OK) database.fail(code, "preparing '" + sql + "' for");
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_), statement_(std::exchange(other.statement_, nullptr)) {}

Statement& Statement::operator=(Statement&& other) noexcept {
  std::swap(database_, other.database_);
  std::swap(statement_, other.statement_);
  return *this;
}

Statement& Statement::bind(int index, std::int64_t value) {
  sqlite3_bind_int64(statement_, index, value);
  return *this;
}

Statement& Statement::bind(int index, double value) {
  sqlite3_bind_double(statement_, index, value);
  return *this;
}

Statement& Statement::bind(int index, std::string_view value) {
  // An empty view may have no address, which SQLite would take for NULL.
  sqlite3_bind_text64(statement_, index, value.empty() ? "" : value.data(), value.size(),
                      SQLITE_TRANSIENT, SQLITE_UTF8);
  return *this;
}

Statement& Statement::bindNull(int index) {
  sqlite3_bind_null(statement_, index);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  const std::string doing = sqlite3_stmt_readonly(statement_) != 0 ? "reading" : "writing";
  sqlite3_reset(statement_);
  database_->fail(code, doing);
}

void Statement::run() {
  const Reading reading(*this);
  while (step()) {
  }
}

void Statement::reset() { sqlite3_reset(statement_); }

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Statement::real(int column) const {
  return isNull(column) ? std::numeric_limits<double>::quiet_NaN()
                        : sqlite3_column_double(statement_, column);
}

std::string_view Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  if (text == nullptr) return {};
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

bool Statement::isNull(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

const char* Statement::sql() const { return sqlite3_sql(statement_); }

Transaction::Transaction(Database& database) : database_(database) {
  runPrepared("BEGIN IMMEDIATE", database.begin_);
}

void Transaction::runPrepared(const char* sql, sqlite3_stmt*& statement) {
  sqlite3* handle = database_.handle();
  int code = SQLITE_OK;
  if (statement == nullptr)
    code = sqlite3_prepare_v3(handle, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code == SQLITE_OK) {
    code = sqlite3_step(statement);
    sqlite3_reset(statement);
  }
  if (code != SQLITE_DONE) database_.fail(code, "writing");
}

Transaction::~Transaction() {
  // A failed statement may have rolled back already; a second rollback is a harmless error.
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  runPrepared("COMMIT", database_.commit_);
  open_ = false;
}

}  // namespace patina::db
