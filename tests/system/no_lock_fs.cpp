// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/no_lock_fs.h"

#include <fcntl.h>
#include <linux/fuse.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace patina::testing {
namespace {

constexpr std::size_t kRequestBytes = 1 << 17;

void reply(int fd, std::uint64_t unique, int error, const void* body, std::size_t bytes) {
  fuse_out_header head{};
  head.len = static_cast<std::uint32_t>(sizeof head + bytes);
  head.error = error;
  head.unique = unique;
  std::array<iovec, 2> parts = {{{&head, sizeof head}, {const_cast<void*>(body), bytes}}};
  [[maybe_unused]] const auto sent = ::writev(fd, parts.data(), bytes > 0 ? 2 : 1);
}

fuse_attr attributes(std::uint64_t id, std::uint32_t mode) {
  fuse_attr attr{};
  attr.ino = id;
  attr.mode = mode;
  attr.nlink = 1;
  attr.blksize = 4096;
  return attr;
}

}  // namespace

NoLockFileSystem::NoLockFileSystem(std::filesystem::path place) : place_(std::move(place)) {
  fd_ = ::open("/dev/fuse", O_RDWR | O_CLOEXEC);
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "/dev/fuse");
  const std::string options =
      "fd=" + std::to_string(fd_) + ",rootmode=40000,user_id=0,group_id=0,allow_other";
  if (::mount("nolock", place_.c_str(), "fuse.nolock", 0, options.c_str()) != 0) {
    const int error = errno;
    ::close(fd_);
    throw std::system_error(error, std::generic_category(), "mounting a file system of ours");
  }
  nodes_.push_back({0, "", S_IFDIR | 0777});
  thread_ = std::thread([this] { serve(); });
}

NoLockFileSystem::~NoLockFileSystem() {
  ::umount2(place_.c_str(), MNT_DETACH);
  thread_.join();
  ::close(fd_);
}

void NoLockFileSystem::serve() {
  std::vector<char> request(kRequestBytes);
  for (;;) {
    const auto got = ::read(fd_, request.data(), request.size());
    if (got < 0 && (errno == EINTR || errno == ENOENT || errno == EAGAIN)) continue;
    if (got <= 0) return;  // unmounted
    answer({request.begin(), request.begin() + got});
  }
}

std::uint64_t NoLockFileSystem::find(std::uint64_t parent, const std::string& name) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].parent == parent && nodes_[i].name == name) return i + 1;
  return 0;
}

std::uint64_t NoLockFileSystem::make(std::uint64_t parent, const std::string& name,
                                     std::uint32_t mode) {
  nodes_.push_back({parent, name, mode});
  return nodes_.size();
}

void NoLockFileSystem::answer(const std::vector<char>& request) {
  fuse_in_header head{};
  std::memcpy(&head, request.data(), sizeof head);
  const char* body = request.data() + sizeof head;
  const auto entry = [&](std::uint64_t id) {
    fuse_entry_out out{};
    out.nodeid = id;
    out.attr = attributes(id, nodes_[id - 1].mode);
    return out;
  };
  switch (head.opcode) {
    case FUSE_INIT: {
      fuse_init_out out{};
      out.major = FUSE_KERNEL_VERSION;
      out.minor = FUSE_KERNEL_MINOR_VERSION;
      out.flags = FUSE_POSIX_LOCKS | FUSE_FLOCK_LOCKS;  // ours to answer, and we refuse
      out.max_write = 65536;
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_LOOKUP: {
      const std::uint64_t id = find(head.nodeid, body);
      if (id == 0) return reply(fd_, head.unique, -ENOENT, nullptr, 0);
      const auto out = entry(id);
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_GETATTR:
    case FUSE_SETATTR: {
      fuse_attr_out out{};
      out.attr = attributes(head.nodeid, nodes_[head.nodeid - 1].mode);
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_MKDIR: {
      const auto out = entry(make(head.nodeid, body + sizeof(fuse_mkdir_in), S_IFDIR | 0777));
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_CREATE: {
      struct {
        fuse_entry_out entry;
        fuse_open_out open;
      } out{};
      out.entry = entry(make(head.nodeid, body + sizeof(fuse_create_in), S_IFREG | 0666));
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_OPEN:
    case FUSE_OPENDIR: {
      const fuse_open_out out{};
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_STATFS: {
      fuse_statfs_out out{};
      out.st.bsize = out.st.frsize = 4096;
      out.st.blocks = out.st.bfree = out.st.bavail = 1 << 20;
      out.st.namelen = 255;
      return reply(fd_, head.unique, 0, &out, sizeof out);
    }
    case FUSE_READDIR:
    case FUSE_FLUSH:
    case FUSE_RELEASE:
    case FUSE_RELEASEDIR:
    case FUSE_FSYNCDIR:
    case FUSE_ACCESS:
      return reply(fd_, head.unique, 0, nullptr, 0);
    case FUSE_FORGET:
    case FUSE_BATCH_FORGET:
    case FUSE_INTERRUPT:
      return;
    default:  // FUSE_SETLK and FUSE_SETLKW first of all
      return reply(fd_, head.unique, -ENOSYS, nullptr, 0);
  }
}

}  // namespace patina::testing
