// SPDX-License-Identifier: GPL-3.0-or-later
// A disk whose every call a test may count, fail or kill at.
#pragma once

#include <cerrno>
#include <functional>
#include <memory>
#include <utility>

#include "db/file_ops.h"

namespace patina::db::testing {

enum class Call {
  kOpen,
  kRead,
  kWrite,
  kSync,
  kTruncate,
  kSize,
  kRename,
  kSyncFolder,
  kMakeFolder,
  kRemove,
  kSpace,
  kLock,
  kIsNetwork
};
constexpr int kShortWrite = 1;  // a hook's answer: write half of it

// The hook answers 0 (go on), -errno (fail) or kShortWrite. Syncs of the real disk are left out:
// a test of processes does not need them, and runs ten times faster.
class HookedDisk final : public FileOps {
 public:
  using Hook = std::function<int(Call, const std::filesystem::path&)>;
  explicit HookedDisk(Hook hook = {}, FileOps& disk = realFileOps())
      : hook_(std::move(hook)), disk_(disk) {}

  int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<File>* out) override {
    const int told = ask(Call::kOpen, path);
    if (told < 0) return told;
    std::unique_ptr<File> file;
    const int got = disk_.open(path, mode, &file);
    if (got >= 0) *out = std::make_unique<Hooked>(*this, path, std::move(file));
    return got;
  }
  int renameNoReplace(const std::filesystem::path& from, const std::filesystem::path& to) override {
    const int told = ask(Call::kRename, to);
    return told < 0 ? told : disk_.renameNoReplace(from, to);
  }
  int renameReplace(const std::filesystem::path& from, const std::filesystem::path& to) override {
    const int told = ask(Call::kRename, to);
    return told < 0 ? told : disk_.renameReplace(from, to);
  }
  int syncFolder(const std::filesystem::path& folder) override {
    const int told = ask(Call::kSyncFolder, folder);
    return told < 0 ? told : 0;
  }
  int makeFolder(const std::filesystem::path& folder) override {
    const int told = ask(Call::kMakeFolder, folder);
    return told < 0 ? told : disk_.makeFolder(folder);
  }
  int remove(const std::filesystem::path& path) override {
    const int told = ask(Call::kRemove, path);
    return told < 0 ? told : disk_.remove(path);
  }
  int space(const std::filesystem::path& folder, Space* out) override {
    const int told = ask(Call::kSpace, folder);
    return told < 0 ? told : disk_.space(folder, out);
  }
  int lock(const std::filesystem::path& path, std::unique_ptr<FileLock>* out) override {
    const int told = ask(Call::kLock, path);
    return told < 0 ? told : disk_.lock(path, out);
  }
  int isNetwork(const std::filesystem::path& folder) override {
    const int told = ask(Call::kIsNetwork, folder);
    return told != 0 ? told : disk_.isNetwork(folder);
  }
  std::unique_ptr<File> adopt(const std::filesystem::path& path,
                              std::unique_ptr<File> file) override {
    return std::make_unique<Hooked>(*this, path, disk_.adopt(path, std::move(file)));
  }

 private:
  int ask(Call call, const std::filesystem::path& path) { return hook_ ? hook_(call, path) : 0; }

  class Hooked final : public File {
   public:
    Hooked(HookedDisk& disk, std::filesystem::path path, std::unique_ptr<File> file)
        : disk_(disk), path_(std::move(path)), file_(std::move(file)) {}
    std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
      const int told = disk_.ask(Call::kRead, path_);
      return told < 0 ? told : file_->read(into, offset);
    }
    std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
      const int told = disk_.ask(Call::kWrite, path_);
      if (told == kShortWrite && data.size() > 1) data = data.first(data.size() / 2);
      return told < 0 ? told : file_->write(data, offset);
    }
    int sync() override {
      const int told = disk_.ask(Call::kSync, path_);
      return told < 0 ? told : 0;
    }
    int truncate(std::int64_t size) override {
      const int told = disk_.ask(Call::kTruncate, path_);
      return told < 0 ? told : file_->truncate(size);
    }
    std::int64_t size() override {
      const int told = disk_.ask(Call::kSize, path_);
      return told < 0 ? told : file_->size();
    }

   private:
    HookedDisk& disk_;
    std::filesystem::path path_;
    std::unique_ptr<File> file_;
  };

  Hook hook_;
  FileOps& disk_;
};

}  // namespace patina::db::testing
