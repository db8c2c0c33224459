// SPDX-License-Identifier: GPL-3.0-or-later
// manifest.json of a set of maps: named values in one flat JSON object. Hides the JSON library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace patina::brdf {

class Manifest {
 public:
  using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>>;

  Manifest& set(const std::string& key, Value value);  // replaces; keeps the order of first setting
  Manifest& text(const std::string& key, const std::string& v) { return set(key, Value{v}); }
  Manifest& number(const std::string& key, double v) { return set(key, Value{v}); }
  Manifest& count(const std::string& key, std::int64_t v) { return set(key, Value{v}); }

  bool has(const std::string& key) const { return find(key) != nullptr; }
  std::optional<std::string> text(const std::string& key) const;
  std::optional<double> number(const std::string& key) const;                // of a count too
  std::optional<std::vector<double>> numbers(const std::string& key) const;  // of an empty list too
  std::optional<std::vector<std::string>> texts(const std::string& key) const;
  const std::vector<std::pair<std::string, Value>>& all() const { return values_; }

  std::string json() const;  // indented; same values, same bytes
  // Throws ProcessingError(kBadData) naming `source`: no JSON object. Nested values and null are
  // left out.
  static Manifest parse(const std::string& json, const std::string& source);

 private:
  const Value* find(const std::string& key) const;
  std::vector<std::pair<std::string, Value>> values_;
};

// FOLDER/manifest.json. Throws ProcessingError(kBadData) when it is missing, over 1 MB or no JSON.
Manifest readManifest(const std::filesystem::path& folder);

}  // namespace patina::brdf
