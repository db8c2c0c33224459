// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal_lines.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "db/failure.h"

namespace patina::db {
namespace {

using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

// Slicing by eight (Kounavis and Berry 2005) of the reflected polynomial 0xEDB88320.
constexpr CrcTables makeCrcTables() {
  CrcTables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
    tables[0][byte] = crc;
  }
  for (std::size_t slice = 1; slice < 8; ++slice)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[slice - 1][byte];
      tables[slice][byte] = (before >> 8) ^ tables[0][before & 0xff];
    }
  return tables;
}
constexpr CrcTables kCrc = makeCrcTables();

// Bytes of the well-formed UTF-8 sequence at the front, 0 when there is none.
std::size_t sequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const unsigned char second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;  // overlong, surrogate, beyond U+10FFFF
  return length;
}

}  // namespace

std::uint32_t crc32(std::string_view data) {
  std::uint32_t crc = 0xFFFFFFFFu;
  const char* at = data.data();
  std::size_t left = data.size();
  for (; left >= 8; at += 8, left -= 8) {
    std::array<unsigned char, 8> b{};
    std::memcpy(b.data(), at, 8);
    crc = kCrc[7][b[0] ^ (crc & 0xff)] ^ kCrc[6][b[1] ^ ((crc >> 8) & 0xff)] ^
          kCrc[5][b[2] ^ ((crc >> 16) & 0xff)] ^ kCrc[4][b[3] ^ (crc >> 24)] ^ kCrc[3][b[4]] ^
          kCrc[2][b[5]] ^ kCrc[1][b[6]] ^ kCrc[0][b[7]];
  }
  for (; left > 0; ++at, --left)
    crc = (crc >> 8) ^ kCrc[0][(crc ^ static_cast<unsigned char>(*at)) & 0xff];
  return ~crc;
}

std::string_view validText(std::string_view text, std::string& copy) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = sequenceLength(text.substr(at));
    if (length == 0) break;
    at += length;
  }
  if (at == text.size()) return text;
  copy.assign(text.substr(0, at));
  while (at < text.size()) {
    const std::size_t length = sequenceLength(text.substr(at));
    copy += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(at, length);
    at += length == 0 ? 1 : length;
  }
  return copy;
}

void JournalLines::begin(const char* table) {
  PATINA_CHECK(!finished_);
  if (open_) seal();
  line_ = text_.size();
  open_ = true;
  text_ += "{\"row\":\"";
  text_ += table;
  text_ += '"';
}

void JournalLines::seal() {
  const std::uint32_t crc = crc32(std::string_view(text_).substr(line_));
  text_ += ",\"crc32\":\"";
  for (int shift = 28; shift >= 0; shift -= 4) text_ += "0123456789abcdef"[(crc >> shift) & 0xf];
  text_ += "\"}\n";
  open_ = false;
}

const std::string& JournalLines::finish() {
  if (open_) {
    text_ += ",\"commit\":true";
    seal();
  }
  finished_ = true;
  return text_;
}

void JournalLines::integer(std::int64_t v) {
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), v).ptr;
  text_.append(digits.data(), end);
}

void JournalLines::real(double v) {
  if (std::isnan(v)) return null();
  if (std::isinf(v)) return text(v > 0 ? "inf" : "-inf");
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), v).ptr;
  text_.append(digits.data(), end);
}

void JournalLines::text(std::string_view v) {
  std::string copy;
  text_ += '"';
  for (const char c : validText(v, copy)) {
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += c;
    } else if (c == '\n') {
      text_ += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      text_ += "\\u00";
      text_ += "0123456789abcdef"[(static_cast<unsigned char>(c) >> 4) & 0xf];
      text_ += "0123456789abcdef"[static_cast<unsigned char>(c) & 0xf];
    } else {
      text_ += c;
    }
  }
  text_ += '"';
}

}  // namespace patina::db
