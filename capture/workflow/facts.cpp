// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/facts.h"

#include <nlohmann/json.hpp>

#include "capture/workflow/failure.h"

namespace patina::workflow {

using Json = nlohmann::ordered_json;

Facts& Facts::set(const std::string& key, Value value) {
  for (auto& [name, old] : values_)
    if (name == key) {
      old = std::move(value);
      return *this;
    }
  values_.emplace_back(key, std::move(value));
  return *this;
}

Facts& Facts::embed(const std::string& key, const Facts& inner) {
  for (const auto& [name, value] : inner.values_)
    set(std::string(key).append(".").append(name), value);
  return *this;
}

std::optional<std::string> Facts::text(const std::string& key) const {
  for (const auto& [name, value] : values_)
    if (name == key)
      if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return std::nullopt;
}

std::optional<double> Facts::number(const std::string& key) const {
  for (const auto& [name, value] : values_) {
    if (name != key) continue;
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* count = std::get_if<std::int64_t>(&value)) return static_cast<double>(*count);
  }
  return std::nullopt;
}

std::vector<std::string> Facts::texts(const std::string& key) const {
  for (const auto& [name, value] : values_)
    if (const auto* list = std::get_if<std::vector<std::string>>(&value); name == key && list)
      return *list;
  return {};
}

bool Facts::flag(const std::string& key) const {
  for (const auto& [name, value] : values_)
    if (name == key)
      if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  return false;
}

std::string Facts::json() const {
  Json object = Json::object();
  for (const auto& [name, value] : values_)
    std::visit([&, &key = name](const auto& v) { object[key] = v; }, value);
  return object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Facts Facts::parse(const std::string& text) {
  Facts facts;
  if (text.empty()) return facts;
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object())
    throw WorkflowError(Exit::kBadData, "metadata is no JSON object: " + text.substr(0, 60));
  for (const auto& [key, value] : object.items()) {
    if (value.is_boolean())
      facts.set(key, value.get<bool>());
    else if (value.is_number_integer())
      facts.count(key, value.get<std::int64_t>());
    else if (value.is_number())
      facts.number(key, value.get<double>());
    else if (value.is_string())
      facts.text(key, value.get<std::string>());
    else if (value.is_array()) {
      std::vector<std::string> list;
      for (const Json& one : value)
        if (one.is_string()) list.push_back(one.get<std::string>());
      facts.set(key, std::move(list));
    }
  }
  return facts;
}

}  // namespace patina::workflow
