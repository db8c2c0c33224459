// SPDX-License-Identifier: GPL-3.0-or-later
// A disk in memory that writes down what happens to it: logged_disk IMAGE LOG READY_FD MOUNT_POINT.
// MOUNT_POINT/disk holds the image's bytes; every write and flush of it becomes a record of LOG,
// and so does every line written to MOUNT_POINT/mark, in the one order they came in (FUSE, one
// thread). A byte goes to READY_FD once it is mounted. Ends when it is unmounted.
#define FUSE_USE_VERSION 35
#include <fuse3/fuse.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "tests/system/powercut/disk_log.h"

namespace {

using patina::testing::RecordHead;
using patina::testing::RecordKind;

constexpr std::string_view kDisk = "/disk", kMark = "/mark";

std::vector<char> disk;
std::FILE* log_file = nullptr;
int ready_fd = -1;

int put(RecordKind kind, off_t offset, const char* bytes, std::size_t size) {
  const RecordHead head{kind, static_cast<std::uint32_t>(size), static_cast<std::uint64_t>(offset)};
  const bool fine = std::fwrite(&head, sizeof head, 1, log_file) == 1 &&
                    std::fwrite(bytes, 1, size, log_file) == size;
  return fine ? static_cast<int>(size) : -EIO;
}

int getAttributes(const char* path, struct stat* out, fuse_file_info* /*file*/) {
  std::memset(out, 0, sizeof *out);
  const bool is_disk = path == kDisk;
  if (path == std::string_view("/")) {
    out->st_mode = S_IFDIR | 0755;
    out->st_nlink = 2;
    return 0;
  }
  if (!is_disk && path != kMark) return -ENOENT;
  out->st_mode = S_IFREG | 0600;
  out->st_nlink = 1;
  out->st_size = is_disk ? static_cast<off_t>(disk.size()) : 0;
  return 0;
}

int openFile(const char* /*path*/, fuse_file_info* file) {
  file->direct_io = 1;  // each write comes as it is made
  return 0;
}

int readDisk(const char* path, char* into, std::size_t size, off_t offset, fuse_file_info*) {
  if (path != kDisk || offset >= static_cast<off_t>(disk.size())) return 0;
  size = std::min(size, disk.size() - static_cast<std::size_t>(offset));
  std::memcpy(into, disk.data() + offset, size);
  return static_cast<int>(size);
}

int writeFile(const char* path, const char* bytes, std::size_t size, off_t offset,
              fuse_file_info*) {
  if (path == kMark) return put(RecordKind::kMark, 0, bytes, size);
  if (static_cast<std::size_t>(offset) + size > disk.size()) return -ENOSPC;
  std::memcpy(disk.data() + offset, bytes, size);
  return put(RecordKind::kWrite, offset, bytes, size);
}

int flushDisk(const char* path, int /*data_only*/, fuse_file_info*) {
  return path == kDisk ? std::min(0, put(RecordKind::kFlush, 0, "", 0)) : 0;
}

int refuseHoles(const char*, int, off_t, off_t, fuse_file_info*) { return -EOPNOTSUPP; }
int keepSize(const char*, off_t, fuse_file_info*) { return 0; }

void* sayReady(fuse_conn_info*, fuse_config*) {
  if (::write(ready_fd, "r", 1) != 1) std::exit(74);
  ::close(ready_fd);
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "logged_disk IMAGE LOG READY_FD MOUNT_POINT\n");
    return 64;
  }
  std::ifstream image(argv[1], std::ios::binary);
  disk.assign(std::istreambuf_iterator<char>(image), {});
  log_file = std::fopen(argv[2], "wb");
  ready_fd = std::atoi(argv[3]);
  if (disk.empty() || log_file == nullptr) return 66;
  fuse_operations operations{};
  operations.init = sayReady;
  operations.getattr = getAttributes;
  operations.open = openFile;
  operations.read = readDisk;
  operations.write = writeFile;
  operations.fsync = flushDisk;
  operations.truncate = keepSize;
  operations.fallocate = refuseHoles;
  std::vector<std::string> words = {argv[0], "-f", "-s", argv[4]};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  const int ended =
      fuse_main(static_cast<int>(arguments.size()), arguments.data(), &operations, nullptr);
  return std::fclose(log_file) == 0 ? ended : 74;
}
