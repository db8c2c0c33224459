// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/mapped_log.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "db/failure.h"

namespace patina::db {
namespace {

constexpr std::int64_t kFirstCapacity = 1 << 20;
constexpr std::uint64_t kSecond = std::uint64_t{1} << 63;  // of the word: which file; else length

int openFile(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0)
    throw ArchiveError(Exit::kIo,
                       "opening " + path.string() + ": " + std::generic_category().message(errno));
  return fd;
}

}  // namespace

// Space is taken before it is mapped: a full disk is an answer here, and SIGBUS is not.
int MappedLog::Mapping::reserve(std::int64_t bytes) {
  if (bytes <= capacity) return 0;
  const std::int64_t wanted = std::max({bytes, 2 * capacity, kFirstCapacity});
  if (const int error = ::posix_fallocate(fd, 0, wanted); error != 0) return -error;
  void* mapped = data == nullptr ? ::mmap(nullptr, static_cast<std::size_t>(wanted),
                                          PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
                                 : ::mremap(data, static_cast<std::size_t>(capacity),
                                            static_cast<std::size_t>(wanted), MREMAP_MAYMOVE);
  if (mapped == MAP_FAILED) return -errno;
  data = static_cast<std::byte*>(mapped);
  capacity = wanted;
  return 0;
}

int MappedLog::Mapping::put(std::int64_t at,
                            std::initializer_list<std::span<const std::byte>> parts) {
  std::int64_t total = 0;
  for (const auto& part : parts) total += static_cast<std::int64_t>(part.size());
  if (const int got = reserve(at + total); got < 0) return got;
  for (const auto& part : parts) {
    if (!part.empty()) std::memcpy(data + at, part.data(), part.size());
    at += static_cast<std::int64_t>(part.size());
  }
  return 0;
}

MappedLog::MappedLog(const std::filesystem::path& folder) {
  logs_[0].fd = openFile(folder / "log0");
  logs_[1].fd = openFile(folder / "log1");
  head_.fd = openFile(folder / "head");
  int got = head_.reserve(sizeof(std::uint64_t));
  for (Mapping& log : logs_) {
    struct stat status {};
    if (got == 0 && ::fstat(log.fd, &status) != 0) got = -errno;
    if (got == 0) got = log.reserve(status.st_size);
  }
  if (got < 0)
    throw ArchiveError(Exit::kIo, "mapping the log in " + folder.string() + ": " +
                                      std::generic_category().message(-got));
  std::uint64_t word = 0;
  std::memcpy(&word, head_.data, sizeof word);
  which_ = (word & kSecond) != 0 ? 1 : 0;
  length_ = std::min(static_cast<std::int64_t>(word & ~kSecond),
                     logs_[static_cast<std::size_t>(which_)].capacity);
}

MappedLog::~MappedLog() {
  for (const Mapping& mapping : {logs_[0], logs_[1], head_}) {
    if (mapping.data != nullptr) ::munmap(mapping.data, static_cast<std::size_t>(mapping.capacity));
    ::close(mapping.fd);
  }
}

std::span<const std::byte> MappedLog::bytes() const {
  return {logs_[static_cast<std::size_t>(which_)].data, static_cast<std::size_t>(length_)};
}

int MappedLog::append(std::initializer_list<std::span<const std::byte>> parts) {
  Mapping& log = logs_[static_cast<std::size_t>(which_)];
  if (const int got = log.put(length_, parts); got < 0) return got;
  std::int64_t length = length_;
  for (const auto& part : parts) length += static_cast<std::int64_t>(part.size());
  store(which_, length);
  return 0;
}

void MappedLog::empty() { store(which_, 0); }

int MappedLog::appendBeside(std::initializer_list<std::span<const std::byte>> parts) {
  Mapping& log = logs_[static_cast<std::size_t>(1 - which_)];
  if (const int got = log.put(beside_length_, parts); got < 0) return got;
  for (const auto& part : parts) beside_length_ += static_cast<std::int64_t>(part.size());
  return 0;
}

void MappedLog::exchange() {
  store(1 - which_, beside_length_);
  beside_length_ = 0;
}

void MappedLog::store(int which, std::int64_t length) {
  which_ = which, length_ = length;
  const auto word = static_cast<std::uint64_t>(length) | (which != 0 ? kSecond : 0);
  // Release: no byte of an entry is stored after the word that counts it.
  std::atomic_ref<std::uint64_t>(*reinterpret_cast<std::uint64_t*>(head_.data))
      .store(word, std::memory_order_release);
}

}  // namespace patina::db
