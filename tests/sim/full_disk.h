// SPDX-License-Identifier: GPL-3.0-or-later
// The real disk, with room for as many bytes as the test says, or gone altogether.
#pragma once

#include <cerrno>
#include <memory>

#include "db/file_ops.h"

namespace patina::testing {

class FullDisk final : public db::FileOps {
 public:
  std::uint64_t free_bytes = 1'000'000'000'000;
  bool writes_fail = false;  // ENOSPC, whatever space() says
  bool unplugged = false;    // EIO

  int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<db::File>* out) override {
    if (unplugged) return -EIO;
    if (writes_fail && mode == Mode::kCreate) return -ENOSPC;
    const int result = real_.open(path, mode, out);
    if (result >= 0) *out = std::make_unique<Guarded>(*this, std::move(*out));
    return result;
  }
  int renameNoReplace(const std::filesystem::path& a, const std::filesystem::path& b) override {
    return unplugged ? -EIO : real_.renameNoReplace(a, b);
  }
  int renameReplace(const std::filesystem::path& a, const std::filesystem::path& b) override {
    return unplugged ? -EIO : real_.renameReplace(a, b);
  }
  int syncFolder(const std::filesystem::path& f) override {
    return unplugged ? -EIO : real_.syncFolder(f);
  }
  int makeFolder(const std::filesystem::path& f) override {
    return unplugged ? -EIO : real_.makeFolder(f);
  }
  int remove(const std::filesystem::path& p) override { return unplugged ? -EIO : real_.remove(p); }
  int space(const std::filesystem::path&, db::Space* out) override {
    *out = {free_bytes, 1'000'000'000'000};
    return unplugged ? -EIO : 0;
  }
  int lock(const std::filesystem::path& p, std::unique_ptr<db::FileLock>* out) override {
    return real_.lock(p, out);
  }
  int isNetwork(const std::filesystem::path& f) override { return real_.isNetwork(f); }
  std::unique_ptr<db::File> adopt(const std::filesystem::path& path,
                                  std::unique_ptr<db::File> file) override {
    return std::make_unique<Guarded>(*this, real_.adopt(path, std::move(file)));
  }

 private:
  class Guarded final : public db::File {
   public:
    Guarded(const FullDisk& disk, std::unique_ptr<db::File> file)
        : disk_(disk), file_(std::move(file)) {}
    std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
      return disk_.unplugged ? -EIO : file_->read(into, offset);
    }
    std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
      if (disk_.unplugged) return -EIO;
      return disk_.writes_fail ? -ENOSPC : file_->write(data, offset);
    }
    int sync() override { return disk_.unplugged ? -EIO : file_->sync(); }
    int truncate(std::int64_t size) override {
      return disk_.unplugged ? -EIO : file_->truncate(size);
    }
    std::int64_t size() override { return file_->size(); }

   private:
    const FullDisk& disk_;
    std::unique_ptr<db::File> file_;
  };
  db::FileOps& real_ = db::realFileOps();
};

}  // namespace patina::testing
