// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that outlive a SIGKILL at the price of a memcpy: two files and a word, mapped and shared.
// What was appended is there when the word says so, which it does last; emptying and replacing the
// whole are one store of the word. Nothing is ever synced.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>

namespace patina::db {

// Thread-bound. One writer a folder. The constructor throws ArchiveError.
class MappedLog {
 public:
  explicit MappedLog(const std::filesystem::path& folder);
  ~MappedLog();
  MappedLog(const MappedLog&) = delete;
  MappedLog& operator=(const MappedLog&) = delete;

  std::span<const std::byte> bytes() const;
  // 0 or -errno (no space): then nothing was appended. Invalidates bytes().
  int append(std::initializer_list<std::span<const std::byte>> parts);
  void empty();

  // A second log beside the first; exchange() puts it in the first one's place, whole.
  int appendBeside(std::initializer_list<std::span<const std::byte>> parts);
  std::int64_t besideLength() const { return beside_length_; }
  void dropBeside() { beside_length_ = 0; }
  void exchange();

 private:
  struct Mapping {
    int fd = -1;
    std::byte* data = nullptr;
    std::int64_t capacity = 0;
    int reserve(std::int64_t bytes);
    int put(std::int64_t at, std::initializer_list<std::span<const std::byte>> parts);
  };
  void store(int which, std::int64_t length);

  std::array<Mapping, 2> logs_;
  Mapping head_;
  int which_ = 0;
  std::int64_t length_ = 0, beside_length_ = 0;
};

}  // namespace patina::db
