// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/json_text.h"

#include <nlohmann/json.hpp>

namespace patina::http {

using Json = nlohmann::json;

std::string jsonString(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<std::map<std::string, std::string>> stringsOfJson(const std::string& text) {
  constexpr std::size_t kBytesMax = 4096;
  if (text.size() > kBytesMax) return std::nullopt;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  std::map<std::string, std::string> strings;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) return std::nullopt;
    strings[key] = value.get<std::string>();
  }
  return strings;
}

}  // namespace patina::http
