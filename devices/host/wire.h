// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of a message: little-endian numbers, text and bytes with their length before them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "processing/image/picture_file.h"

namespace patina::devices::host {

class Writer {
 public:
  void u8(std::uint8_t v) { number(v, 1); }
  void u16(std::uint16_t v) { number(v, 2); }
  void u32(std::uint32_t v) { number(v, 4); }
  void u64(std::uint64_t v) { number(v, 8); }
  void i64(std::int64_t v) { number(static_cast<std::uint64_t>(v), 8); }
  void f64(double v);
  void bytes(std::span<const std::byte> v);
  void text(std::string_view v) { bytes(std::as_bytes(std::span(v.data(), v.size()))); }

  Bytes take() { return std::move(bytes_); }

 private:
  void number(std::uint64_t v, int bytes);

  Bytes bytes_;
};

// After a field that is not there, or has no such length, all fields read as nothing and ok() is
// false: the caller looks once, at the end. Borrows the message.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> message) : rest_(message) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::int64_t i64() { return static_cast<std::int64_t>(number(8)); }
  double f64();
  bool flag() { return number(1) != 0; }
  Bytes bytes();
  std::string text();

  bool ok() const { return ok_; }
  bool whole() const { return ok_ && rest_.empty(); }  // and nothing is left over

 private:
  std::uint64_t number(int bytes);
  std::span<const std::byte> take(std::size_t bytes);

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace patina::devices::host
