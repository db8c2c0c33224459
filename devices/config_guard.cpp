// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_guard.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

#include "devices/config_file.h"

namespace patina::devices {
namespace {

constexpr std::size_t kQuotedMax = 60;
constexpr const char* kHexDigits = "0123456789abcdef";

// Bytes of the well-formed UTF-8 sequence at `at` (Unicode 15, table 3-7), or 0.
std::size_t utf8Length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
  };
  const auto tail = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned lead = byte(0), second = byte(1);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return tail(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const bool overlong = lead == 0xE0 && second < 0xA0, surrogate = lead == 0xED && second > 0x9F;
    return tail(1) && tail(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const bool overlong = lead == 0xF0 && second < 0x90, beyond = lead == 0xF4 && second > 0x8F;
    return tail(1) && tail(2) && tail(3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

// Follows strings and comments just far enough to know what stands outside of them.
class Lexer {
 public:
  // Returns how many characters were consumed; `problem` is left alone when there is none.
  std::size_t step(std::string_view rest, const char*& problem) {
    const char c = rest[0];
    if (quote_ != 0) return stepInString(rest);
    if (comment_) {
      comment_ = c != '\n';
    } else if (c == '#') {
      comment_ = true;
    } else if (c == '"' || c == '\'') {
      quote_ = c;
      triple_ = rest.size() >= 3 && rest[1] == c && rest[2] == c;
      return triple_ ? 3 : 1;
    } else if (c == '[' || c == '{') {
      open_ += c == '[' ? ']' : '}';
      if (open_.size() > kConfigBracketsMax) problem = "nests brackets deeper than 16";
    } else if (c == ']' || c == '}') {
      if (!open_.ends_with(c)) problem = "closes a bracket that is not open";
      if (!open_.empty()) open_.pop_back();
    } else if (static_cast<unsigned char>(c) >= 0x80) {
      problem = "has a letter outside of quotes that is none of A-Z a-z";
    }
    return 1;
  }
  bool betweenLines() const { return open_.empty() && quote_ == 0 && !comment_; }

 private:
  std::size_t stepInString(std::string_view rest) {
    if (quote_ == '"' && rest[0] == '\\' && rest.size() > 1 && rest[1] != '\n') return 2;
    if (triple_) {
      std::size_t quotes = 0;  // up to two belong to the text, just before the closing three
      while (quotes < 5 && quotes < rest.size() && rest[quotes] == quote_) ++quotes;
      if (quotes < 3) return std::max<std::size_t>(1, quotes);
      quote_ = 0;
      return quotes;
    }
    // A line end inside a plain string is the parser's error; it stops there.
    if (rest[0] == quote_ || rest[0] == '\n') quote_ = 0;
    return 1;
  }

  std::string open_;  // the closing brackets to come
  char quote_ = 0;
  bool triple_ = false, comment_ = false;
};

// "[x" "[[x" 'a = 1', but no "[=" or "[.": the parser's own assertion fails on those.
bool startsWell(std::string_view line) {
  const auto skip = [&](std::string_view what, std::size_t most) {
    const std::size_t end = std::min(line.find_first_not_of(what), line.size());
    line.remove_prefix(std::min(end, most));
  };
  skip(" \t", line.size());
  if (!line.starts_with('[')) return true;
  skip("[", 2);
  skip(" \t", line.size());
  const auto c = static_cast<unsigned char>(line.empty() ? 0 : line[0]);
  return (c < 0x80 && std::isalnum(c)) || c == '_' || c == '-' || c == '"' || c == '\'';
}

}  // namespace

void guardConfigText(std::string_view toml, const std::filesystem::path& source) {
  if (toml.size() > kConfigBytesMax) {
    throw ConfigError(source, 0, "", "is longer than 64 KiB, the most a configuration may have");
  }
  int line = 1, dots = 0;
  for (std::size_t at = 0; at < toml.size();) {
    const std::size_t length = utf8Length(toml, at);
    if (length == 0) throw ConfigError(source, line, "", "is not UTF-8 text");
    if (toml[at] == '\0') throw ConfigError(source, line, "", "holds a NUL byte");
    if (toml[at] == '.' && ++dots > kConfigDotsALineMax) {
      throw ConfigError(source, line, "", "has more than 100 dots on one line");
    }
    if (toml[at] == '\n') ++line, dots = 0;
    at += length;
  }
  Lexer lexer;
  line = 1;
  const std::size_t start = toml.starts_with("\xef\xbb\xbf") ? 3 : 0;  // byte order mark
  for (std::size_t at = start; at < toml.size();) {
    const char* problem = nullptr;
    const bool begins = at == start || toml[at - 1] == '\n';
    if (begins && lexer.betweenLines() && !startsWell(toml.substr(at))) {
      problem = "is a table header without a name, as [camera]";
    }
    const bool ends = toml[at] == '\n';
    at += lexer.step(toml.substr(at), problem);
    if (problem) throw ConfigError(source, line, "", problem);
    if (ends) ++line;
  }
}

std::string quoteForMessage(std::string_view text) {
  std::string quoted;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = std::max<std::size_t>(1, utf8Length(text, at));
    if (quoted.size() + length > kQuotedMax) return quoted + "...";
    const auto byte = static_cast<unsigned char>(text[at]);
    if (byte < 0x20 || byte == 0x7F || (byte >= 0x80 && length == 1)) {
      quoted += {'\\', 'x', kHexDigits[byte >> 4], kHexDigits[byte & 15]};
    } else {
      quoted += text.substr(at, length);
    }
    at += length;
  }
  return quoted;
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t least = word.size() < 4 ? 2 : 3;
  if (word.size() > 64) return nearest;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);  // Levenshtein, one row at a time
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = std::exchange(row[0], i + 1);
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t change = diagonal + (word[i] == candidate[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({change, row[j] + 1, diagonal + 1});
      }
    }
    if (row.back() < least) least = row.back(), nearest = candidate;
  }
  return nearest;
}

}  // namespace patina::devices
