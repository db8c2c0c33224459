// SPDX-License-Identifier: GPL-3.0-or-later
// The little JSON the front door itself speaks. json_text.cpp is its only file with a JSON library.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace patina::http {

// Quoted; bytes that are no UTF-8 are replaced.
std::string jsonString(const std::string& text);
// An object of strings and nothing else, at most 4 KiB; nothing when it is anything else.
std::optional<std::map<std::string, std::string>> stringsOfJson(const std::string& text);

}  // namespace patina::http
