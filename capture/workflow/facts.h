// SPDX-License-Identifier: GPL-3.0-or-later
// Named values that travel as JSON: provenance, options and the metadata of products. Hides the
// JSON library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace patina::workflow {

class Facts {
 public:
  using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

  Facts& set(const std::string& key, Value value);  // replaces; keeps the order of first setting
  Facts& text(const std::string& key, const std::string& value) { return set(key, Value{value}); }
  Facts& count(const std::string& key, std::int64_t value) { return set(key, Value{value}); }
  Facts& number(const std::string& key, double value) { return set(key, Value{value}); }
  Facts& embed(const std::string& key, const Facts& inner);  // keys "key.inner"

  std::optional<std::string> text(const std::string& key) const;
  std::optional<double> number(const std::string& key) const;    // of a count too
  bool flag(const std::string& key) const;                       // false when it is not there
  std::vector<std::string> texts(const std::string& key) const;  // empty when they are not there
  const std::vector<std::pair<std::string, Value>>& all() const { return values_; }

  std::string json() const;                              // one line; same facts, same bytes
  static Facts parse(const std::string& json_or_empty);  // what is not of these types is left out

 private:
  std::vector<std::pair<std::string, Value>> values_;
};

}  // namespace patina::workflow
