// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/plain_tiff.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace patina {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kEntryBytes = 12;

std::size_t bytesOf(std::uint16_t type) {
  switch (static_cast<TiffType>(type)) {
    case TiffType::kByte:
    case TiffType::kText:
      return 1;
    case TiffType::kShort:
      return 2;
    case TiffType::kLong:
    case TiffType::kDirectory:
      return 4;
    case TiffType::kRational:
    case TiffType::kSignedRational:
      return 8;
  }
  return 0;
}

template <class T>
void append(Bytes& to, T v) {
  const std::size_t at = to.size();
  to.resize(at + sizeof v);
  std::memcpy(to.data() + at, &v, sizeof v);
}

template <class T>
T numberAt(std::span<const std::byte> file, std::uint64_t offset) {
  T v{};
  std::memcpy(&v, file.data() + offset, sizeof v);
  return v;
}

bool inside(std::span<const std::byte> file, std::uint64_t offset, std::uint64_t bytes) {
  return offset <= file.size() && bytes <= file.size() - offset;
}

}  // namespace

void TiffDirectoryWriter::add(std::uint16_t tag, TiffType type, std::size_t count,
                              std::span<const std::byte> value) {
  Entry entry{tag, static_cast<std::uint16_t>(type), static_cast<std::uint32_t>(count), 0, false};
  if (value.size() <= sizeof entry.value) {
    std::memcpy(&entry.value, value.data(), value.size());
  } else {
    values_.resize((values_.size() + 1) & ~std::size_t{1});
    entry.value = static_cast<std::uint32_t>(values_.size());
    entry.outside = true;
    values_.insert(values_.end(), value.begin(), value.end());
  }
  entries_.push_back(entry);
}

void TiffDirectoryWriter::bytes(std::uint16_t tag, std::span<const std::uint8_t> values) {
  add(tag, TiffType::kByte, values.size(), std::as_bytes(values));
}

void TiffDirectoryWriter::text(std::uint16_t tag, const std::string& value) {
  add(tag, TiffType::kText, value.size() + 1,
      std::as_bytes(std::span(value.c_str(), value.size() + 1)));
}

void TiffDirectoryWriter::shorts(std::uint16_t tag, std::initializer_list<std::uint16_t> values) {
  add(tag, TiffType::kShort, values.size(),
      std::as_bytes(std::span(values.begin(), values.size())));
}

void TiffDirectoryWriter::number(std::uint16_t tag, TiffType type, std::uint32_t value) {
  PATINA_CHECK(type == TiffType::kLong || type == TiffType::kDirectory);
  add(tag, type, 1, std::as_bytes(std::span(&value, 1)));
}

void TiffDirectoryWriter::size(std::uint16_t tag, std::uint32_t value) {
  if (value > std::numeric_limits<std::uint16_t>::max()) return number(tag, TiffType::kLong, value);
  shorts(tag, {static_cast<std::uint16_t>(value)});
}

void TiffDirectoryWriter::rationals(std::uint16_t tag, TiffType type,
                                    std::span<const TiffRational> values) {
  PATINA_CHECK(type == TiffType::kRational || type == TiffType::kSignedRational);
  add(tag, type, values.size(), std::as_bytes(values));
}

std::uint32_t TiffDirectoryWriter::appendTo(Bytes& file) const {
  file.resize((file.size() + 1) & ~std::size_t{1});
  const std::size_t begin = file.size();
  const std::size_t values = begin + 2 + entries_.size() * kEntryBytes + 4;
  PATINA_CHECK(values + values_.size() <= std::numeric_limits<std::uint32_t>::max());
  file.reserve(values + values_.size());
  std::vector<Entry> sorted = entries_;
  std::ranges::sort(sorted, {}, &Entry::tag);
  append(file, static_cast<std::uint16_t>(sorted.size()));
  for (const Entry& entry : sorted) {
    append(file, entry.tag);
    append(file, entry.type);
    append(file, entry.count);
    append(file, entry.value + (entry.outside ? static_cast<std::uint32_t>(values) : 0));
  }
  append(file, std::uint32_t{0});
  file.insert(file.end(), values_.begin(), values_.end());
  return static_cast<std::uint32_t>(begin);
}

std::optional<TiffDirectory> TiffDirectory::at(std::span<const std::byte> file,
                                               std::uint64_t offset) {
  if (!inside(file, offset, 2)) return std::nullopt;
  const int count = numberAt<std::uint16_t>(file, offset);
  if (!inside(file, offset + 2, kEntryBytes * static_cast<std::uint64_t>(count)))
    return std::nullopt;
  return TiffDirectory(file, offset + 2, count);
}

std::optional<TiffDirectory> TiffDirectory::first(std::span<const std::byte> file) {
  static constexpr char kMagic[4] = {'I', 'I', 42, 0};
  if (!inside(file, 0, 8) || std::memcmp(file.data(), kMagic, sizeof kMagic) != 0)
    return std::nullopt;
  return at(file, numberAt<std::uint32_t>(file, 4));
}

std::optional<TiffDirectory::Entry> TiffDirectory::find(std::uint16_t tag) const {
  for (int i = 0; i < count_; ++i) {
    const std::uint64_t entry = entries_ + kEntryBytes * static_cast<std::uint64_t>(i);
    if (numberAt<std::uint16_t>(file_, entry) != tag) continue;
    Entry found;
    found.type = numberAt<std::uint16_t>(file_, entry + 2);
    found.count = numberAt<std::uint32_t>(file_, entry + 4);
    const std::uint64_t bytes = bytesOf(found.type) * std::uint64_t{found.count};
    const std::uint64_t value = bytes <= 4 ? entry + 8 : numberAt<std::uint32_t>(file_, entry + 8);
    if (!inside(file_, value, bytes)) return std::nullopt;
    found.value = file_.subspan(value, bytes);
    return found;
  }
  return std::nullopt;
}

bool TiffDirectory::has(std::uint16_t tag) const {
  for (int i = 0; i < count_; ++i)
    if (numberAt<std::uint16_t>(file_, entries_ + kEntryBytes * static_cast<std::uint64_t>(i)) ==
        tag)
      return true;
  return false;
}

std::span<const std::byte> TiffDirectory::value(std::uint16_t tag, TiffType type,
                                                std::uint32_t count) const {
  const auto found = find(tag);
  if (!found || found->type != static_cast<std::uint16_t>(type) || found->count != count) return {};
  return found->value;
}

std::optional<std::uint32_t> TiffDirectory::number(std::uint16_t tag) const {
  const auto found = find(tag);
  if (!found || found->count != 1) return std::nullopt;
  switch (static_cast<TiffType>(found->type)) {
    case TiffType::kShort:
      return numberAt<std::uint16_t>(found->value, 0);
    case TiffType::kLong:
    case TiffType::kDirectory:
      return numberAt<std::uint32_t>(found->value, 0);
    default:
      return std::nullopt;
  }
}

std::optional<TiffRational> TiffDirectory::rational(std::uint16_t tag) const {
  const auto bytes = value(tag, TiffType::kRational, 1);
  if (bytes.empty()) return std::nullopt;
  return TiffRational{numberAt<std::uint32_t>(bytes, 0), numberAt<std::uint32_t>(bytes, 4)};
}

std::string TiffDirectory::text(std::uint16_t tag) const {
  const auto found = find(tag);
  if (!found || found->type != static_cast<std::uint16_t>(TiffType::kText)) return {};
  const auto* begin = reinterpret_cast<const char*>(found->value.data());
  return {begin, std::find(begin, begin + found->value.size(), '\0')};
}

}  // namespace patina
