// SPDX-License-Identifier: GPL-3.0-or-later
// What a verb answers: rows whose keys are column names, printed at the end as a table for people
// or as one JSON object, {"schema":"patina.<verb>/1","items":[...]}.
#pragma once

#include <concepts>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "processing/image/failure.h"
#include "processing/image/units.h"

namespace patina::app {

using Value =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::string>>;

class Item {
 public:
  struct Field {
    std::string key;
    Value value;
    std::string text;  // for people; empty: the value itself
  };
  Item& set(const std::string& key, Value value, const std::string& text = {});
  Item& set(const std::string& key, const char* value) {
    return set(key, Value{std::string(value)});
  }
  template <std::integral T>
  requires(!std::same_as<T, bool>) Item& set(const std::string& key, T value) {
    return set(key, Value{static_cast<std::int64_t>(value)});
  }
  Item& set(const std::string& key, UtcTime value);      // as nanoseconds; ISO 8601 for people
  Item& set(const std::string& key, Nanoseconds value);  // as nanoseconds; "10min" for people
  Item& bytes(const std::string& key, std::uint64_t value);
  Item& hidden(const std::string& key, Value value);  // only in JSON
  const std::vector<Field>& fields() const { return fields_; }

 private:
  std::vector<Field> fields_;
};

class Output {
 public:
  // `verb`: "ttf build" becomes patina.ttf.build/1.
  Output(std::string verb, bool json, bool quiet);

  void add(Item item) { items_.push_back(std::move(item)); }
  // A plain sentence for people, printed above the rows; not under --json, not under --quiet.
  void say(const std::string& sentence) { sentences_.push_back(sentence); }
  // Rows as a table, or, for a single thing, one field a line.
  void asList() { list_ = true; }
  bool empty() const { return items_.empty(); }
  std::string text() const;  // all of it

 private:
  std::string table() const;
  std::string list() const;
  std::string verb_;
  bool json_, quiet_, list_ = false;
  std::vector<std::string> sentences_;
  std::vector<Item> items_;
};

// The one line of an error on stderr, in the form that was asked for.
std::string errorText(Exit exit, const std::string& message, bool json);
std::string warningText(const std::string& message, bool json);

}  // namespace patina::app
