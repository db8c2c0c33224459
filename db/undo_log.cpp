// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/undo_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

#include "db/failure.h"

namespace patina::db {
namespace {

// A log that nothing needs any more is emptied only now and then: truncating costs more than
// appending.
constexpr std::int64_t kEmptyAtBytes = 256 << 10;
constexpr std::int64_t kCompactAtBytes = 8 << 20;
constexpr std::uint32_t kMagic = 0x6f646e75;

struct Header {
  std::uint32_t magic, kind;
  std::uint64_t seq, file, upto, inode;
  std::int64_t offset, bytes, old_size;
  std::uint32_t saved, path_bytes, to_bytes, stuck;
  std::int64_t image_bytes;
};

[[noreturn]] void fail(const std::string& doing, const std::filesystem::path& path, int error) {
  throw ArchiveError(Exit::kIo,
                     doing + " " + path.string() + ": " + std::generic_category().message(error));
}

Header headerOf(const UndoEntry& e, std::size_t image_bytes) {
  return {kMagic,
          static_cast<std::uint32_t>(e.kind),
          e.seq,
          e.file,
          e.upto,
          e.inode,
          e.offset,
          e.bytes,
          e.old_size,
          e.saved,
          static_cast<std::uint32_t>(e.path.native().size()),
          static_cast<std::uint32_t>(e.to.native().size()),
          e.stuck ? 1u : 0u,
          static_cast<std::int64_t>(image_bytes)};
}

UndoEntry entryOf(const Header& h, const char* names) {
  UndoEntry e;
  e.kind = static_cast<UndoEntry::Kind>(h.kind);
  e.seq = h.seq, e.file = h.file, e.upto = h.upto, e.inode = h.inode;
  e.offset = h.offset, e.bytes = h.bytes, e.old_size = h.old_size;
  e.saved = h.saved, e.stuck = h.stuck != 0;
  e.path = std::string(names, h.path_bytes);
  e.to = std::string(names + h.path_bytes, h.to_bytes);
  e.image_bytes = h.image_bytes;
  return e;
}

int copyFile(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
  return -error.value();
}

}  // namespace

UndoLog::UndoLog(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder_ / "grave", error);
  if (error) fail("making the undo log", folder_, error.value());
  fd_ = ::open((folder_ / "log").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) fail("opening the undo log", folder_, errno);
  load();
}

UndoLog::~UndoLog() { ::close(fd_); }

int UndoLog::add(UndoEntry entry, std::span<const std::byte> image) {
  entry.seq = next_seq_;
  const int got = append(entry, image);
  if (got < 0) return got;
  ++next_seq_;
  entry.image_at = length_ - static_cast<std::int64_t>(image.size());
  entry.image_bytes = static_cast<std::int64_t>(image.size());
  unsynced_.apply(entry);
  if (entry.changesBytes() || entry.changesNames()) return 0;
  dropSpentGraves();
  if (unsynced_.empty() && length_ > kEmptyAtBytes && ::ftruncate(fd_, 0) == 0) length_ = 0;
  if (length_ > kCompactAtBytes && length_ > 2 * unsynced_.imageBytes()) return compact();
  return 0;
}

std::vector<std::byte> UndoLog::image(const UndoEntry& entry) const {
  std::vector<std::byte> bytes(static_cast<std::size_t>(entry.image_bytes));
  const ssize_t got = ::pread(fd_, bytes.data(), bytes.size(), entry.image_at);
  if (got != static_cast<ssize_t>(bytes.size())) fail("reading the undo log", folder_, EIO);
  return bytes;
}

std::filesystem::path UndoLog::grave(std::uint64_t seq) const {
  return folder_ / "grave" / std::to_string(seq);
}

int UndoLog::bury(const std::filesystem::path& file, std::uint64_t seq) {
  const std::filesystem::path to = grave(seq);
  ::unlink(to.c_str());
  if (::link(file.c_str(), to.c_str()) == 0) return 0;
  return errno == EXDEV || errno == EPERM ? copyFile(file, to) : -errno;
}

void UndoLog::forget() {
  if (::ftruncate(fd_, 0) != 0) fail("emptying the undo log", folder_, errno);
  length_ = 0;
  unsynced_ = Unsynced();
  for (const auto& grave : std::filesystem::directory_iterator(folder_ / "grave"))
    std::filesystem::remove(grave);
}

void UndoLog::load() {
  std::vector<std::byte> log(
      static_cast<std::size_t>(std::max<off_t>(0, ::lseek(fd_, 0, SEEK_END))));
  if (::pread(fd_, log.data(), log.size(), 0) != static_cast<ssize_t>(log.size()))
    fail("reading the undo log", folder_, EIO);
  UndoEntry last;
  std::size_t at = 0;
  for (;;) {
    Header h;
    if (log.size() - at < sizeof h) break;
    std::memcpy(&h, log.data() + at, sizeof h);
    const std::size_t names = at + sizeof h, image = names + h.path_bytes + h.to_bytes;
    // A kill may cut the last append short; its change was then never made.
    if (h.magic != kMagic || image + static_cast<std::size_t>(h.image_bytes) > log.size()) break;
    UndoEntry entry = entryOf(h, reinterpret_cast<const char*>(log.data()) + names);
    entry.image_at = static_cast<std::int64_t>(image);
    at = image + static_cast<std::size_t>(h.image_bytes);
    next_seq_ = std::max(next_seq_, entry.seq + 1);
    next_file_ = std::max(next_file_, entry.file + 1);
    unsynced_.apply(entry);
    last = std::move(entry);
  }
  length_ = static_cast<std::int64_t>(at);
  if (::ftruncate(fd_, length_) != 0) fail("cutting the undo log", folder_, errno);
  settle(last);
  dropSpentGraves();
}

// The last change was announced; was it made? Written down, since after the cut nobody could tell.
void UndoLog::settle(const UndoEntry& last) {
  if (!last.changesNames()) return;
  struct stat status {};
  const auto& there = last.to.empty() ? last.path : last.to;
  const bool exists = ::lstat(there.c_str(), &status) == 0;
  bool made = exists;
  if (last.kind == UndoEntry::Kind::kRename) made = exists && status.st_ino == last.inode;
  if (last.kind == UndoEntry::Kind::kRemove) made = !exists;
  UndoEntry verdict;
  verdict.kind = made ? UndoEntry::Kind::kHappened : UndoEntry::Kind::kCancelled;
  verdict.upto = last.seq;
  const int got = add(verdict);
  if (got < 0) fail("writing the undo log", folder_, -got);
}

int UndoLog::append(const UndoEntry& entry, std::span<const std::byte> image) {
  Header header = headerOf(entry, image.size());
  std::array<iovec, 4> parts = {{{&header, sizeof header},
                                 {const_cast<char*>(entry.path.c_str()), header.path_bytes},
                                 {const_cast<char*>(entry.to.c_str()), header.to_bytes},
                                 {const_cast<std::byte*>(image.data()), image.size()}}};
  std::int64_t total = 0;
  for (const iovec& part : parts) total += static_cast<std::int64_t>(part.iov_len);
  const ssize_t got = ::pwritev(fd_, parts.data(), static_cast<int>(parts.size()), length_);
  if (got < 0) return -errno;
  if (got != total) return -ENOSPC;
  length_ += total;
  return 0;
}

// Writes what is still unsynced into a new log. Names first: a file's path is then today's.
int UndoLog::compact() {
  const std::filesystem::path fresh = folder_ / "log.new";
  const int fd = ::open(fresh.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return -errno;
  const int old_fd = fd_;
  const std::int64_t old_length = length_;
  Unsynced kept;
  int got = 0;
  const auto take = [&](UndoEntry entry) {
    if (got < 0) return;
    fd_ = old_fd;
    const std::vector<std::byte> bytes = image(entry);
    fd_ = fd;
    got = append(entry, bytes);
    entry.image_at = length_ - entry.image_bytes;
    kept.apply(entry);
  };
  length_ = 0;
  for (const UndoEntry& name : unsynced_.names()) take(name);
  for (const auto& [file, state] : unsynced_.files())
    for (UndoEntry change : state.changes) {
      change.path = state.path;
      change.upto = state.removed_by;
      take(std::move(change));
    }
  if (got == 0 && ::rename(fresh.c_str(), (folder_ / "log").c_str()) == 0) {
    unsynced_ = std::move(kept);
    ::close(old_fd);
    return 0;
  }
  fd_ = old_fd, length_ = old_length;  // the old log still says everything
  ::close(fd);
  return 0;
}

void UndoLog::dropSpentGraves() {
  for (const std::uint64_t seq : unsynced_.takeSpentGraves()) ::unlink(grave(seq).c_str());
}

}  // namespace patina::db
