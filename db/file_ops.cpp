// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/file_ops.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace patina::db {
namespace {

// The answer of a system call in our convention, EINTR retried.
template <class Call>
std::int64_t answer(Call call) {
  for (;;) {
    const std::int64_t got = call();
    if (got >= 0) return got;
    if (errno != EINTR) return -errno;
  }
}

int openDescriptor(const std::filesystem::path& path, int flags) {
  return static_cast<int>(answer([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0666); }));
}

class RealFile final : public File {
 public:
  explicit RealFile(int fd) : fd_(fd) {}
  ~RealFile() override { ::close(fd_); }
  RealFile(const RealFile&) = delete;
  RealFile& operator=(const RealFile&) = delete;

  std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
    return answer([&] { return ::pread(fd_, into.data(), into.size(), offset); });
  }
  std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
    return answer([&] { return ::pwrite(fd_, data.data(), data.size(), offset); });
  }
  int sync() override {
    return static_cast<int>(answer([&] { return ::fdatasync(fd_); }));
  }
  int truncate(std::int64_t size) override {
    return static_cast<int>(answer([&] { return ::ftruncate(fd_, size); }));
  }
  std::int64_t size() override {
    struct stat status {};
    const std::int64_t got = answer([&] { return ::fstat(fd_, &status); });
    return got < 0 ? got : static_cast<std::int64_t>(status.st_size);
  }
  void dropCache() override { ::posix_fadvise(fd_, 0, 0, POSIX_FADV_DONTNEED); }

 private:
  int fd_;
};

class RealLock final : public FileLock {
 public:
  explicit RealLock(int fd) : fd_(fd) {}
  ~RealLock() override { ::close(fd_); }
  RealLock(const RealLock&) = delete;
  RealLock& operator=(const RealLock&) = delete;

 private:
  int fd_;
};

class RealFileOps final : public FileOps {
 public:
  int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<File>* out) override {
    // pwrite() on an O_APPEND descriptor ignores its offset, so appending is left to the caller.
    int flags = O_RDONLY;
    if (mode == Mode::kCreate) flags = O_RDWR | O_CREAT | O_EXCL;
    if (mode == Mode::kUpdate) flags = O_RDWR;
    if (mode == Mode::kAppend) flags = O_RDWR | O_CREAT;
    const int fd = openDescriptor(path, flags);
    if (fd < 0) return fd;
    *out = std::make_unique<RealFile>(fd);
    return 0;
  }

  int renameNoReplace(const std::filesystem::path& from, const std::filesystem::path& to) override {
    return static_cast<int>(answer([&] {
      return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
    }));
  }

  int renameReplace(const std::filesystem::path& from, const std::filesystem::path& to) override {
    return static_cast<int>(answer([&] { return ::rename(from.c_str(), to.c_str()); }));
  }

  int syncFolder(const std::filesystem::path& folder) override {
    const int fd = openDescriptor(folder, O_RDONLY | O_DIRECTORY);
    if (fd < 0) return fd;
    const int got = static_cast<int>(answer([&] { return ::fsync(fd); }));
    ::close(fd);
    return got;
  }

  int makeFolder(const std::filesystem::path& folder) override {
    return static_cast<int>(answer([&] { return ::mkdir(folder.c_str(), 0777); }));
  }

  int remove(const std::filesystem::path& path) override {
    return static_cast<int>(answer([&] { return ::unlink(path.c_str()); }));
  }

  int space(const std::filesystem::path& folder, Space* out) override {
    struct statvfs status {};
    const int got = static_cast<int>(answer([&] { return ::statvfs(folder.c_str(), &status); }));
    if (got < 0) return got;
    out->free_bytes = static_cast<std::uint64_t>(status.f_bavail) * status.f_frsize;
    out->total_bytes = static_cast<std::uint64_t>(status.f_blocks) * status.f_frsize;
    return 0;
  }

  int lock(const std::filesystem::path& path, std::unique_ptr<FileLock>* out) override {
    const int fd = openDescriptor(path, O_RDWR | O_CREAT);
    if (fd < 0) return fd;
    auto held = std::make_unique<RealLock>(fd);
    const int got = static_cast<int>(answer([&] { return ::flock(fd, LOCK_EX | LOCK_NB); }));
    if (got == 0) *out = std::move(held);
    return got;
  }

  int isNetwork(const std::filesystem::path& folder) override {
    // statfs(2) and linux/magic.h: NFS, SMB, SMB2, CIFS, NCP, AFS (two), Coda, Ceph, 9P, GFS2,
    // OCFS2.
    constexpr std::array<std::uint32_t, 12> kNetwork = {
        0x6969,     0x517B,     0xFE534D42, 0xFF534D42, 0x564C,     0x5346414F,
        0x6B414653, 0x73757245, 0x00C36400, 0x01021997, 0x01161970, 0x7461636F};
    struct statfs status {};
    const int got = static_cast<int>(answer([&] { return ::statfs(folder.c_str(), &status); }));
    if (got < 0) return got;
    return std::ranges::find(kNetwork, static_cast<std::uint32_t>(status.f_type)) != kNetwork.end()
               ? 1
               : 0;
  }

  std::unique_ptr<File> adopt(const std::filesystem::path& /*path*/,
                              std::unique_ptr<File> file) override {
    return file;
  }
};

}  // namespace

FileOps& realFileOps() {
  static RealFileOps ops;
  return ops;
}

}  // namespace patina::db
