// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "db/cells.h"
#include "db/errors.h"
#include "db/journal.h"
#include "db/journal_lines.h"

namespace patina::db {
namespace {

using Json = nlohmann::json;

// Reads a row's columns from an object. Throws nlohmann's exceptions when it is not that row.
class JsonReader {
 public:
  explicit JsonReader(const Json& object) : object_(object) {}
  template <class T>
  void operator()(const char* column, T&& field) {
    value_ = &object_.at(column);
    get(*this, field);
  }
  bool isNull() const { return value_->is_null(); }
  // By reference: get<>() would also take a number with a fraction, or of any size.
  std::int64_t integer() const { return value_->get_ref<const Json::number_integer_t&>(); }
  double real() const {
    if (value_->is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (value_->is_string()) return *value_ == "inf" ? HUGE_VAL : -HUGE_VAL;
    return value_->get<double>();
  }
  const std::string& text() const { return value_->get_ref<const std::string&>(); }

 private:
  const Json& object_;
  const Json* value_ = nullptr;
};

template <std::size_t I = 0>
std::optional<AnyRow> rowOf(const Json& object, std::string_view table) {
  if constexpr (I == std::variant_size_v<AnyRow>) {
    return std::nullopt;
  } else {
    using Row = std::variant_alternative_t<I, AnyRow>;
    if (table != Table<Row>::kName) return rowOf<I + 1>(object, table);
    Row row{};
    JsonReader reader(object);
    columns(reader, row);
    return row;
  }
}

constexpr std::string_view kCrcMember = ",\"crc32\":\"";
constexpr std::size_t kCrcLength = kCrcMember.size() + 8 + 2;  // digits, quote, brace

bool crcHolds(std::string_view line) {
  if (line.size() <= kCrcLength) return false;
  const std::string_view tail = line.substr(line.size() - kCrcLength);
  if (!tail.starts_with(kCrcMember) || !tail.ends_with("\"}")) return false;
  std::uint32_t stored = 0;
  for (const char c : tail.substr(kCrcMember.size(), 8)) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit && !(c >= 'a' && c <= 'f')) return false;
    stored = stored << 4 | static_cast<std::uint32_t>(digit ? c - '0' : c - 'a' + 10);
  }
  return stored == crc32(line.substr(0, line.size() - kCrcLength));
}

// Adds the line's row to the batch; true when it ends the transaction.
bool takeLine(std::string_view line, JournalBatch& batch) {
  if (!crcHolds(line)) {
    ++batch.bad_lines;
    return false;
  }
  try {
    const Json object = Json::parse(line);
    auto row = rowOf(object, object.at("row").get_ref<const std::string&>());
    // A table of a later schema: its lines are kept, and cannot be understood here.
    row ? batch.rows.push_back(std::move(*row)) : static_cast<void>(++batch.bad_lines);
    return object.contains("commit");
  } catch (const Json::exception&) {
    ++batch.bad_lines;
  } catch (const Failure&) {
    ++batch.bad_lines;
  }
  return false;
}

}  // namespace

std::int64_t scanJournal(FileOps& files, const std::filesystem::path& path, std::int64_t from,
                         std::int64_t to, const std::function<void(JournalBatch&&)>& each) {
  constexpr std::int64_t kBlock = 1 << 20;
  std::unique_ptr<File> file;
  checkDisk(files.open(path, FileOps::Mode::kRead, &file), "opening", path);
  std::string block;
  std::size_t used = 0;          // of block, already taken
  std::int64_t block_at = from;  // offset of block's first byte
  JournalBatch batch;
  batch.begin = from;
  std::int64_t whole = from;
  for (;;) {
    const std::size_t newline = block.find('\n', used);
    if (newline == std::string::npos) {
      block.erase(0, used);
      block_at += static_cast<std::int64_t>(used);
      used = 0;
      const std::size_t kept = block.size();
      const std::int64_t at = block_at + static_cast<std::int64_t>(kept);
      const std::int64_t wanted = std::min(kBlock, to - at);
      if (wanted <= 0) return whole;
      block.resize(kept + static_cast<std::size_t>(wanted));
      const std::int64_t got =
          file->read(std::as_writable_bytes(std::span(block).subspan(kept)), at);
      checkDisk(got, "reading", path);
      if (got == 0) return whole;
      block.resize(kept + static_cast<std::size_t>(got));
      continue;
    }
    const bool last = takeLine(std::string_view(block).substr(used, newline - used), batch);
    used = newline + 1;
    if (!last) continue;
    batch.end = whole = block_at + static_cast<std::int64_t>(used);
    each(std::move(batch));
    batch = JournalBatch{};
    batch.begin = whole;
  }
}

}  // namespace patina::db
