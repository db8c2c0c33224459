// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/wire.h"

#include <bit>

namespace patina::devices::host {

void Writer::number(std::uint64_t v, int bytes) {
  for (int i = 0; i < bytes; ++i) bytes_.push_back(static_cast<std::byte>(v >> (8 * i) & 0xff));
}

void Writer::f64(double v) { u64(std::bit_cast<std::uint64_t>(v)); }

void Writer::bytes(std::span<const std::byte> v) {
  u64(v.size());
  bytes_.insert(bytes_.end(), v.begin(), v.end());
}

std::span<const std::byte> Reader::take(std::size_t bytes) {
  if (!ok_ || bytes > rest_.size()) {
    ok_ = false;
    return {};
  }
  const auto taken = rest_.first(bytes);
  rest_ = rest_.subspan(bytes);
  return taken;
}

std::uint64_t Reader::number(int bytes) {
  std::uint64_t v = 0;
  const auto field = take(static_cast<std::size_t>(bytes));
  for (std::size_t i = 0; i < field.size(); ++i)
    v |= std::to_integer<std::uint64_t>(field[i]) << (8 * i);
  return v;
}

double Reader::f64() { return std::bit_cast<double>(u64()); }

Bytes Reader::bytes() {
  const auto field = take(u64());
  return {field.begin(), field.end()};
}

std::string Reader::text() {
  const auto field = take(u64());
  return {reinterpret_cast<const char*>(field.data()), field.size()};
}

}  // namespace patina::devices::host
