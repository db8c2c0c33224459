// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/escapes.h"

#include <cctype>
#include <string_view>

namespace patina::devices::serial {
namespace {

constexpr std::string_view kLetters = "rnt0\\", kBytes("\r\n\t\0\\", 5);
constexpr std::string_view kHex = "0123456789abcdef";

std::optional<int> hexDigit(char c) {
  const auto at = kHex.find(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  if (at == std::string_view::npos) return std::nullopt;
  return static_cast<int>(at);
}

}  // namespace

std::optional<std::string> unescape(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
      continue;
    }
    if (++i == text.size()) return std::nullopt;
    if (const auto letter = kLetters.find(text[i]); letter != std::string_view::npos) {
      bytes += kBytes[letter];
      continue;
    }
    if (text[i] != 'x' || i + 2 >= text.size()) return std::nullopt;
    const auto high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
    if (!high || !low) return std::nullopt;
    bytes += static_cast<char>(*high * 16 + *low);
    i += 2;
  }
  return bytes;
}

std::string escape(const std::string& bytes) {
  constexpr std::size_t kLongest = 60;
  std::string text;
  for (const char c : bytes.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\\') {
      text += "\\\\";
    } else if (byte >= 0x20 && byte < 0x7f) {
      text += c;
    } else {
      text += "\\x";
      text += kHex[byte >> 4];
      text += kHex[byte & 15];
    }
  }
  return bytes.size() > kLongest ? text + "..." : text;
}

}  // namespace patina::devices::serial
