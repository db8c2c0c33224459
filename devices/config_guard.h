// SPDX-License-Identifier: GPL-3.0-or-later
// What is checked on a TOML text before a parser sees it, and how a hostile text is quoted.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patina::devices {

// Throws ConfigError: too long, too many dots a line, too deep brackets, NUL, not UTF-8. O(bytes).
void guardConfigText(std::string_view toml, const std::filesystem::path& source);

// At most 60 characters, on one line, control characters as "\x1b".
std::string quoteForMessage(std::string_view text);

// The candidate within two edits (one for short words), else "".
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace patina::devices
