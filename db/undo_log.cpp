// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/undo_log.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "db/failure.h"

namespace patina::db {
namespace {

constexpr std::int64_t kCompactAtBytes = 1 << 20;
constexpr std::uint32_t kMagic = 0x6f646e75;

struct Header {
  std::uint32_t magic, kind;
  std::uint64_t seq, file, upto, inode;
  std::int64_t offset, bytes, old_size;
  std::uint32_t saved, path_bytes, to_bytes, stuck;
  std::int64_t image_bytes;
};

const std::filesystem::path& madeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "grave", error);
  if (error) throw ArchiveError(Exit::kIo, "making " + folder.string() + ": " + error.message());
  return folder;
}

[[noreturn]] void failDamaged(const std::filesystem::path& folder) {
  throw ArchiveError(Exit::kBadData, "the undo log in " + folder.string() +
                                         " is damaged: what a power cut would take is unknown");
}

std::span<const std::byte> bytesOf(const Header& header) {
  return std::as_bytes(std::span(&header, 1));
}
std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

Header headerOf(const UndoEntry& e) {
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
          static_cast<std::uint32_t>(e.path.size()),
          static_cast<std::uint32_t>(e.to.size()),
          e.stuck ? 1u : 0u,
          e.image_bytes};
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

UndoLog::UndoLog(const std::filesystem::path& folder)
    : folder_(folder), log_(madeFolder(folder)), compact_at_(kCompactAtBytes) {
  load();
}

int UndoLog::add(UndoEntry entry, std::span<const std::byte> image) {
  entry.seq = next_seq_;
  entry.image_bytes = static_cast<std::int64_t>(image.size());
  const Header header = headerOf(entry);
  const int got = log_.append({bytesOf(header), bytesOf(entry.path), bytesOf(entry.to), image});
  if (got < 0) return got;
  ++next_seq_;
  entry.image_at = length() - entry.image_bytes;
  const bool changes = entry.changesBytes() || entry.changesNames();
  unsynced_.apply(std::move(entry));
  if (changes) return 0;
  dropSpentGraves();
  if (unsynced_.empty())
    log_.empty();
  else if (length() > compact_at_)
    compact();
  return 0;
}

std::span<const std::byte> UndoLog::image(const UndoEntry& entry) const {
  return log_.bytes().subspan(static_cast<std::size_t>(entry.image_at),
                              static_cast<std::size_t>(entry.image_bytes));
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
  log_.empty();
  unsynced_ = Unsynced();
  for (const auto& grave : std::filesystem::directory_iterator(folder_ / "grave"))
    std::filesystem::remove(grave);
}

std::int64_t UndoLog::length() const { return static_cast<std::int64_t>(log_.bytes().size()); }

void UndoLog::load() {
  const std::span<const std::byte> log = log_.bytes();
  UndoEntry last;
  for (std::size_t at = 0; at < log.size();) {
    Header h;
    if (log.size() - at < sizeof h) failDamaged(folder_);
    std::memcpy(&h, log.data() + at, sizeof h);
    const std::size_t names = at + sizeof h, image = names + h.path_bytes + h.to_bytes;
    if (h.magic != kMagic || image + static_cast<std::size_t>(h.image_bytes) > log.size())
      failDamaged(folder_);
    UndoEntry entry = entryOf(h, reinterpret_cast<const char*>(log.data()) + names);
    entry.image_at = static_cast<std::int64_t>(image);
    at = image + static_cast<std::size_t>(h.image_bytes);
    next_seq_ = std::max(next_seq_, entry.seq + 1);
    next_file_ = std::max(next_file_, entry.file + 1);
    last = entry;
    unsynced_.apply(std::move(entry));
  }
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
  if (const int got = add(verdict); got < 0)
    throw ArchiveError(Exit::kIo, "no space for the undo log in " + folder_.string());
}

// Puts a log of what is still unsynced in the place of this one. Names first: a file's path is then
// today's. Without space the old log stays; it says everything too.
void UndoLog::compact() {
  Unsynced kept;
  bool whole = true;
  const auto take = [&](UndoEntry entry) {
    const std::span<const std::byte> bytes = image(entry);
    const Header header = headerOf(entry);
    whole = whole && log_.appendBeside(
                         {bytesOf(header), bytesOf(entry.path), bytesOf(entry.to), bytes}) == 0;
    entry.image_at = log_.besideLength() - entry.image_bytes;
    kept.apply(std::move(entry));
  };
  for (const UndoEntry& name : unsynced_.names()) take(name);
  for (const auto& [file, state] : unsynced_.files())
    for (UndoEntry change : state.changes) {
      change.path = state.path;
      change.upto = state.removed_by;
      take(std::move(change));
    }
  compact_at_ = 2 * length();
  if (!whole) return log_.dropBeside();
  log_.exchange();
  unsynced_ = std::move(kept);
  compact_at_ = std::max(kCompactAtBytes, 2 * length());
}

void UndoLog::dropSpentGraves() {
  for (const std::uint64_t seq : unsynced_.takeSpentGraves()) ::unlink(grave(seq).c_str());
}

}  // namespace patina::db
