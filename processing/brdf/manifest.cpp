// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/manifest.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "processing/image/picture_file.h"

namespace patina::brdf {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kBytesMax = 1 << 20;

// The list as one of numbers or one of texts; nothing for what is neither.
std::optional<Manifest::Value> listOf(const Json& list) {
  const auto all = [&](auto is) { return std::all_of(list.begin(), list.end(), is); };
  if (all([](const Json& v) { return v.is_number(); })) return list.get<std::vector<double>>();
  if (all([](const Json& v) { return v.is_string(); })) return list.get<std::vector<std::string>>();
  return std::nullopt;
}

std::optional<Manifest::Value> valueOf(const Json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array()) return listOf(value);
  return std::nullopt;
}

}  // namespace

const Manifest::Value* Manifest::find(const std::string& key) const {
  const auto at = std::find_if(values_.begin(), values_.end(),
                               [&](const auto& entry) { return entry.first == key; });
  return at == values_.end() ? nullptr : &at->second;
}

Manifest& Manifest::set(const std::string& key, Value value) {
  for (auto& [name, old] : values_)
    if (name == key) {
      old = std::move(value);
      return *this;
    }
  values_.emplace_back(key, std::move(value));
  return *this;
}

std::optional<std::string> Manifest::text(const std::string& key) const {
  if (const Value* value = find(key))
    if (const auto* text = std::get_if<std::string>(value)) return *text;
  return std::nullopt;
}

std::optional<double> Manifest::number(const std::string& key) const {
  const Value* value = find(key);
  if (!value) return std::nullopt;
  if (const auto* number = std::get_if<double>(value)) return *number;
  if (const auto* count = std::get_if<std::int64_t>(value)) return static_cast<double>(*count);
  return std::nullopt;
}

std::optional<std::vector<double>> Manifest::numbers(const std::string& key) const {
  if (const Value* value = find(key))
    if (const auto* numbers = std::get_if<std::vector<double>>(value)) return *numbers;
  return std::nullopt;
}

std::optional<std::vector<std::string>> Manifest::texts(const std::string& key) const {
  const Value* value = find(key);
  if (!value) return std::nullopt;
  if (const auto* texts = std::get_if<std::vector<std::string>>(value)) return *texts;
  if (const auto* numbers = std::get_if<std::vector<double>>(value); numbers && numbers->empty())
    return std::vector<std::string>();
  return std::nullopt;
}

std::string Manifest::json() const {
  Json object = Json::object();
  for (const auto& [name, value] : values_)
    std::visit([&, &key = name](const auto& v) { object[key] = v; }, value);
  return object.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Manifest Manifest::parse(const std::string& json, const std::string& source) {
  const Json object = Json::parse(json, nullptr, false);
  if (!object.is_object())
    throw ProcessingError(Exit::kBadData, source + " is no JSON object: it is damaged");
  Manifest manifest;
  for (const auto& [key, value] : object.items())
    if (auto known = valueOf(value)) manifest.set(key, std::move(*known));
  return manifest;
}

Manifest readManifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw ProcessingError(Exit::kBadData,
                          folder.string() + " is no set of maps: it has no manifest.json");
  const Bytes bytes = readFile(file, kBytesMax);
  return Manifest::parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                         file.string());
}

}  // namespace patina::brdf
