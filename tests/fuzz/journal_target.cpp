// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of the journal. Most changes break a line's CRC and are told by that alone, so that the
// bytes are read twice: as they are, and as objects of which each gets the CRC it needs.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "db/file_ops.h"
#include "db/journal.h"
#include "db/journal_lines.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

// A disk of one file in memory, to be read.
class OneFile final : public db::FileOps {
 public:
  explicit OneFile(std::string text) : text_(std::move(text)) {}
  std::int64_t size() const { return static_cast<std::int64_t>(text_.size()); }

  int open(const std::filesystem::path&, Mode, std::unique_ptr<db::File>* out) override {
    *out = std::make_unique<Open>(text_);
    return 0;
  }
  int renameNoReplace(const std::filesystem::path&, const std::filesystem::path&) override {
    return -EROFS;
  }
  int renameReplace(const std::filesystem::path&, const std::filesystem::path&) override {
    return -EROFS;
  }
  int syncFolder(const std::filesystem::path&) override { return 0; }
  int makeFolder(const std::filesystem::path&) override { return -EROFS; }
  int remove(const std::filesystem::path&) override { return -EROFS; }
  int space(const std::filesystem::path&, db::Space*) override { return 0; }
  int lock(const std::filesystem::path&, std::unique_ptr<db::FileLock>*) override { return -EROFS; }
  int isNetwork(const std::filesystem::path&) override { return 0; }
  std::unique_ptr<db::File> adopt(const std::filesystem::path&,
                                  std::unique_ptr<db::File> file) override {
    return file;
  }

 private:
  class Open final : public db::File {
   public:
    explicit Open(const std::string& text) : text_(text) {}
    std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
      const auto from = std::min(static_cast<std::size_t>(offset), text_.size());
      const std::size_t bytes = std::min(into.size(), text_.size() - from);
      std::memcpy(into.data(), text_.data() + from, bytes);
      return static_cast<std::int64_t>(bytes);
    }
    std::int64_t write(std::span<const std::byte>, std::int64_t) override { return -EROFS; }
    int sync() override { return 0; }
    int truncate(std::int64_t) override { return -EROFS; }
    std::int64_t size() override { return static_cast<std::int64_t>(text_.size()); }

   private:
    const std::string& text_;
  };
  std::string text_;
};

void scan(const std::string& text) {
  OneFile disk(text);
  db::scanJournal(disk, "journal", 0, disk.size(), [](db::JournalBatch&&) {});
}

// Each line as an object with the CRC it needs.
std::string sealed(const std::string& text) {
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    std::string line = text.substr(from, to - from);
    from = to + 1;
    const auto old = line.rfind(",\"crc32\"");
    if (old != std::string::npos) line.resize(old);
    char crc[32];
    std::snprintf(crc, sizeof crc, ",\"crc32\":\"%08x\"}\n", db::crc32(line));
    out += line + crc;
  }
  return out;
}

}  // namespace

void fuzzJournal(std::span<const std::byte> bytes) {
  const std::string text = textOf(bytes);
  scan(text);
  scan(sealed(text));
}

}  // namespace patina::testing
