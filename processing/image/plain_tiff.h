// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: directories of little-endian TIFF files, written and read without libtiff.
// That one sorts its table of all known tags for every directory it touches, which costs a small
// DNG more than its samples do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "processing/image/picture_file.h"

namespace patina {

enum class TiffType : std::uint16_t {
  kByte = 1,
  kText = 2,
  kShort = 3,
  kLong = 4,
  kRational = 5,
  kSignedRational = 10,
  kDirectory = 13
};

struct TiffRational {
  std::uint32_t top = 0, bottom = 1;
};

// One directory to be written. Values longer than four bytes follow it in the order they were
// added.
class TiffDirectoryWriter {
 public:
  void bytes(std::uint16_t tag, std::span<const std::uint8_t> values);
  void text(std::uint16_t tag, const std::string& value);  // and a zero
  void shorts(std::uint16_t tag, std::initializer_list<std::uint16_t> values);
  void number(std::uint16_t tag, TiffType type, std::uint32_t value);  // kLong or kDirectory
  void size(std::uint16_t tag, std::uint32_t value);                   // kShort where it fits
  void rationals(std::uint16_t tag, TiffType type, std::span<const TiffRational> values);

  // Appends it to a file of less than 4 GiB, at an even offset, which is the answer. No directory
  // follows it.
  std::uint32_t appendTo(Bytes& file) const;

 private:
  struct Entry {
    std::uint16_t tag = 0, type = 0;
    std::uint32_t count = 0;
    std::uint32_t value = 0;  // itself, or where it lies in values_
    bool outside = false;
  };
  void add(std::uint16_t tag, TiffType type, std::size_t count, std::span<const std::byte> value);
  std::vector<Entry> entries_;
  Bytes values_;
};

// One directory of a file in memory. Answers nothing for what is absent, of another type, or not
// inside the file.
class TiffDirectory {
 public:
  // Nothing when it does not lie inside the file, which must outlive it.
  static std::optional<TiffDirectory> at(std::span<const std::byte> file, std::uint64_t offset);
  // The first one of a little-endian file.
  static std::optional<TiffDirectory> first(std::span<const std::byte> file);

  bool has(std::uint16_t tag) const;
  std::span<const std::byte> value(std::uint16_t tag, TiffType type, std::uint32_t count) const;
  std::optional<std::uint32_t> number(std::uint16_t tag) const;  // one kShort, kLong, kDirectory
  std::optional<TiffRational> rational(std::uint16_t tag) const;
  std::string text(std::uint16_t tag) const;  // empty when absent

 private:
  TiffDirectory(std::span<const std::byte> file, std::uint64_t entries, int count)
      : file_(file), entries_(entries), count_(count) {}
  struct Entry {
    std::uint16_t type = 0;
    std::uint32_t count = 0;
    std::span<const std::byte> value;
  };
  std::optional<Entry> find(std::uint16_t tag) const;
  std::span<const std::byte> file_;
  std::uint64_t entries_;  // offset
  int count_;
};

}  // namespace patina
