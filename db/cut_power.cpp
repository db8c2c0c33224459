// SPDX-License-Identifier: GPL-3.0-or-later
// The supervisor's half of the power cut: puts the plan into effect on the folder.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <span>
#include <string>
#include <system_error>

#include "db/cut_plan.h"
#include "db/failure.h"
#include "db/power_cut.h"
#include "db/undo_log.h"

namespace patina::db {
namespace {

using Kind = UndoEntry::Kind;

[[noreturn]] void fail(const std::string& doing, const std::filesystem::path& path, int error) {
  throw ArchiveError(Exit::kIo,
                     doing + " " + path.string() + ": " + std::generic_category().message(error));
}

using BeforeChange = std::function<void()>;

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags, const BeforeChange& before)
      : before_(before), path_(path), fd_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool isOpen() const { return fd_ >= 0; }
  std::int64_t size() const {
    struct stat status {};
    if (::fstat(fd_, &status) != 0) fail("taking back", path_, errno);
    return status.st_size;
  }
  void write(const std::byte* data, std::int64_t bytes, std::int64_t offset) const {
    while (bytes > 0) {
      before_();
      const ssize_t got = ::pwrite(fd_, data, static_cast<std::size_t>(bytes), offset);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) fail("taking back", path_, errno);
      data += got, bytes -= got, offset += got;
    }
  }
  void read(void* into, std::size_t bytes) const {
    if (::pread(fd_, into, bytes, 0) != static_cast<ssize_t>(bytes)) fail("reading", path_, EIO);
  }
  void truncate(std::int64_t bytes) const {
    before_();
    if (::ftruncate(fd_, bytes) != 0) fail("taking back", path_, errno);
  }

 private:
  const BeforeChange& before_;
  std::filesystem::path path_;
  int fd_;
};

// How far a cut has come, so that the next one can go on where it was killed.
struct CutProgress {
  std::uint64_t seed = 0;
  std::uint64_t bytes_done = 0;  // 1 when every file has its bytes
  std::uint64_t names_done = 0;
};

// A disk does not touch what it loses: times of files and folders stay those of the dead process.
class KeptTimes {
 public:
  void keep(const std::filesystem::path& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) == 0) times_.try_emplace(path, status.st_mtim);
  }
  void putBack() const {
    for (const auto& [path, time] : times_) {
      const timespec times[2] = {{0, UTIME_OMIT}, time};
      ::utimensat(AT_FDCWD, path.c_str(), times, AT_SYMLINK_NOFOLLOW);  // gone: nothing to keep
    }
  }

 private:
  std::map<std::filesystem::path, timespec> times_;
};

// Where a lost sector of a write gets its old bytes from: the image, and zeros behind the old end
// (the file may have kept its new size without the bytes).
void restore(const Descriptor& file, const UndoEntry& e, std::span<const std::byte> image,
             std::int64_t from, std::int64_t to) {
  const std::int64_t image_end = e.offset + e.image_bytes;
  const std::int64_t split = std::clamp(image_end, from, to);
  if (from < split) file.write(image.data() + (from - e.offset), split - from, from);
  if (split < to) {
    const std::vector<std::byte> zeros(static_cast<std::size_t>(to - split));
    file.write(zeros.data(), to - split, split);
  }
}

// Takes change `index` back, sector by sector; the end of what survives of it, 0 when nothing does.
std::int64_t takeBack(const Descriptor& file, const UndoEntry& e, std::size_t index,
                      const FileCut& cut, std::span<const std::byte> image) {
  if (e.kind == Kind::kTruncate) {
    if (index >= cut.kept) restore(file, e, image, e.offset, e.offset + e.image_bytes);
    return index < cut.kept ? e.offset : 0;
  }
  const std::int64_t end = e.offset + e.bytes;
  std::int64_t survived = 0, lost_from = -1;
  for (std::int64_t at = e.offset; at < end;) {
    const std::int64_t sector = at / cut.sector * cut.sector;
    const std::int64_t next = std::min(end, sector + cut.sector);
    if (cut.survives(index, sector)) {
      if (lost_from >= 0) restore(file, e, image, lost_from, at);
      lost_from = -1, survived = next;
    } else if (lost_from < 0) {
      lost_from = at;
    }
    at = next;
  }
  if (lost_from >= 0) restore(file, e, image, lost_from, end);
  return survived;
}

void takeBackBytes(const UndoLog& log, const FileCut& cut, const BeforeChange& before,
                   CutReport* report) {
  const Unsynced::OneFile& state = log.unsynced().files().at(cut.file);
  const auto& changes = state.changes;
  const bool buried = state.removed_by != 0;
  const Descriptor file(buried ? log.grave(state.removed_by) : std::filesystem::path(state.path),
                        O_WRONLY, before);
  report->writes_lost += static_cast<int>(changes.size() - cut.kept);
  if (!file.isOpen()) return;  // somebody else removed it

  // The next change that moved the end knows where it was.
  const auto moved =
      std::ranges::find_if(changes.begin() + static_cast<std::ptrdiff_t>(cut.kept), changes.end(),
                           [](const UndoEntry& e) { return e.old_size >= 0; });
  std::int64_t size = moved != changes.end() ? moved->old_size : file.size();
  for (std::size_t i = changes.size(); i-- > 0;) {
    if (i < cut.kept && cut.tear != FileCut::Tear::kReordered) break;
    const std::int64_t survived = takeBack(file, changes[i], i, cut, log.image(changes[i]));
    if (i == cut.kept && cut.tear == FileCut::Tear::kTorn && survived > 0) {
      ++report->torn;
      size = std::max(size, survived);
    }
  }
  file.truncate(size);
}

// Moves `from` to `to`, whatever file systems they lie on. Gone already: done before.
void bringBack(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0 || errno == ENOENT) return;
  if (errno != EXDEV) fail("taking back", to, errno);
  std::error_code error;
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) std::filesystem::remove(from, error);
  if (error) fail("taking back", to, error.value());
}

void takeBackName(const UndoLog& log, const UndoEntry& e) {
  switch (e.kind) {
    case Kind::kCreate:
      if (::unlink(e.path.c_str()) != 0 && errno != ENOENT && errno != ENOTDIR)
        fail("taking back", e.path, errno);
      return;
    case Kind::kMakeFolder:
      std::filesystem::remove_all(e.path);
      return;
    case Kind::kRename: {
      struct stat status {};
      if (::lstat(e.to.c_str(), &status) == 0 && status.st_ino == e.inode) bringBack(e.to, e.path);
      if (e.saved != 0) bringBack(log.grave(e.seq), e.to);
      return;
    }
    case Kind::kRemove:
      if (e.saved != 0) bringBack(log.grave(e.seq), e.path);
      return;
    default:
      return;
  }
}

}  // namespace

CutReport cutPower(const std::filesystem::path& log_folder, std::uint64_t seed,
                   const std::function<void()>& before_change) {
  const BeforeChange before = before_change ? before_change : [] {};
  UndoLog log(log_folder);
  const Descriptor noted(log_folder / "cut", O_RDWR | O_CREAT, before);
  if (!noted.isOpen()) fail("opening", log_folder / "cut", errno);
  CutProgress progress{.seed = seed};
  const auto note = [&] {
    noted.write(reinterpret_cast<const std::byte*>(&progress), sizeof progress, 0);
  };
  if (noted.size() == sizeof progress) noted.read(&progress, sizeof progress);
  note();

  CutReport report;
  const CutPlan plan = planCut(log.unsynced(), progress.seed);
  report.files = static_cast<int>(log.unsynced().files().size());
  for (const auto& [file, state] : log.unsynced().files())
    report.writes += static_cast<int>(state.changes.size());
  report.names = static_cast<int>(log.unsynced().names().size());
  report.names_lost = static_cast<int>(plan.names.size());
  KeptTimes times;
  for (const UndoEntry& e : plan.names)
    for (const std::filesystem::path path : {e.path, e.to})
      if (!path.empty()) times.keep(path.parent_path());
  for (const FileCut& cut : plan.files) times.keep(log.unsynced().files().at(cut.file).path);
  if (progress.bytes_done == 0) {
    for (const FileCut& cut : plan.files) takeBackBytes(log, cut, before, &report);
    progress.bytes_done = 1;
    note();
  }
  while (progress.names_done < plan.names.size()) {
    before();
    takeBackName(log, plan.names[progress.names_done++]);
    note();
  }
  before();
  times.putBack();
  before();
  log.forget();
  before();
  std::filesystem::remove(log_folder / "cut");
  return report;
}

}  // namespace patina::db
