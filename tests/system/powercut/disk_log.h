// SPDX-License-Identifier: GPL-3.0-or-later
// What happened to a disk, in order, and the disk as a power cut would have left it: what was
// flushed is there; of what was not, each 4 KiB may be, as a seed decides.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace patina::testing {

enum class RecordKind : std::uint32_t { kWrite = 1, kFlush = 2, kMark = 3 };
struct RecordHead {  // in the log, before its bytes
  RecordKind kind;
  std::uint32_t size;
  std::uint64_t offset;
};

// Goes forward only. A disk that does not lie about flushes; it tears writes at 4 KiB, the block of
// both file systems (a torn superblock is a matter of theirs, not ours).
class DiskReplay {
 public:
  DiskReplay(const std::filesystem::path& image, const std::filesystem::path& log);

  std::size_t records() const { return records_.size(); }
  // Before record number `cut`.
  void forwardTo(std::size_t cut);
  // Lines that were written to the mark until here.
  const std::vector<std::string>& marks() const { return marks_; }
  std::string cut(std::uint64_t seed) const;

 private:
  struct Record {
    RecordHead head;
    std::size_t at;  // its bytes in log_
  };
  void apply(std::string& disk, const Record& record, std::size_t from, std::size_t size) const;

  std::string disk_, log_;
  std::vector<Record> records_;
  std::size_t position_ = 0;
  std::vector<std::size_t> pending_;  // writes since the last flush
  std::vector<std::string> marks_;
};

}  // namespace patina::testing
