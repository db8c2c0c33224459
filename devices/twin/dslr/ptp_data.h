// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes of PTP data sets: little-endian numbers, counted UTF-16 strings, counted arrays.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "processing/image/picture_file.h"

namespace patina::devices::twin::dslr {

class PtpWriter {
 public:
  void u8(std::uint8_t v) { number(v, 1); }
  void u16(std::uint16_t v) { number(v, 2); }
  void u32(std::uint32_t v) { number(v, 4); }
  void u64(std::uint64_t v) { number(v, 8); }
  void number(std::uint64_t v, int bytes);
  // ASCII, at most 254 characters; empty is one zero byte.
  void text(const std::string& ascii);
  void u16s(const std::vector<std::uint16_t>& values);
  void u32s(const std::vector<std::uint32_t>& values);
  void raw(std::span<const std::byte> bytes);
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

// Of bytes that a stranger sent: reading past the end gives zeros and makes bad() true for ever.
class PtpReader {
 public:
  explicit PtpReader(std::span<const std::byte> bytes) : rest_(bytes) {}
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t number(int bytes);
  std::string text();  // '?' for what is not ASCII
  std::span<const std::byte> raw(std::size_t bytes);
  std::size_t left() const { return rest_.size(); }
  bool bad() const { return bad_; }

 private:
  std::span<const std::byte> rest_;
  bool bad_ = false;
};

}  // namespace patina::devices::twin::dslr
