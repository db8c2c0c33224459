// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/byte_range.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace patina::http {
namespace {

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

ByteRange chooseRange(std::string_view field, std::uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  constexpr ByteRange kRefused{ByteRange::kRefused, 0, 0};
  if (field.empty()) return {ByteRange::kWhole, 0, size};
  if (!field.starts_with(kUnit) || size == 0) return kRefused;
  field.remove_prefix(kUnit.size());
  const std::size_t dash = field.find('-');
  if (dash == std::string_view::npos) return kRefused;
  const auto left = number(field.substr(0, dash)), right = number(field.substr(dash + 1));
  if (dash == 0) {  // the last so many bytes
    if (!right || *right == 0) return kRefused;
    const std::uint64_t bytes = std::min(*right, size);
    return {ByteRange::kPart, size - bytes, bytes};
  }
  if (!left || *left >= size) return kRefused;
  if (dash + 1 == field.size()) return {ByteRange::kPart, *left, size - *left};
  if (!right || *right < *left) return kRefused;
  return {ByteRange::kPart, *left, std::min(*right, size - 1) - *left + 1};
}

}  // namespace patina::http
