// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/gc_marks.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <sstream>

#include "db/care/backup_files.h"
#include "db/errors.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;

fs::path marksPath(const fs::path& archive) { return archive / "care" / "gc-marks"; }

Identity identityOfOne(const fs::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return {};
  const auto ns = [](const timespec& t) { return t.tv_sec * 1'000'000'000 + t.tv_nsec; };
  return {status.st_ino, S_ISDIR(status.st_mode) ? 0 : static_cast<std::int64_t>(status.st_size),
          std::max(ns(status.st_mtim), ns(status.st_ctim))};
}

}  // namespace

Identity identityOf(const fs::path& path) {
  Identity all = identityOfOne(path);
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(path, error)) {
    const Identity one = identityOfOne(entry.path());
    all.bytes += one.bytes;
    all.changed_ns = std::max(all.changed_ns, one.changed_ns);
  }
  return all;
}

std::string readWhole(FileOps& files, const fs::path& path) {
  const Loaded loaded = load(files, path);
  if (loaded.error == ENOENT) return {};
  checkDisk(-loaded.error, "reading", path);
  return {reinterpret_cast<const char*>(loaded.bytes.data()), loaded.bytes.size()};
}

void writeWhole(FileOps& files, const fs::path& path, const std::string& text) {
  const fs::path fresh = path.string() + ".new";
  files.remove(fresh);
  {
    std::unique_ptr<File> file;
    checkDisk(files.open(fresh, FileOps::Mode::kCreate, &file), "creating", fresh);
    auto left = std::as_bytes(std::span(text));
    std::int64_t at = 0;
    while (!left.empty()) {
      const std::int64_t put = file->write(left, at);
      if (put <= 0) throwDiskError(put < 0 ? static_cast<int>(-put) : ENOSPC, "writing", fresh);
      at += put;
      left = left.subspan(static_cast<std::size_t>(put));
    }
    checkDisk(file->sync(), "syncing", fresh);
  }
  checkDisk(files.renameReplace(fresh, path), "renaming to", path);
  checkDisk(files.syncFolder(path.parent_path()), "syncing", path.parent_path());
}

// A line: inode, bytes, changed, since, and the path to the line's end.
Marks readMarks(FileOps& files, const fs::path& archive) {
  Marks marks;
  std::istringstream text(readWhole(files, marksPath(archive)));
  Mark mark;
  std::int64_t since = 0;
  std::string path;
  while (text >> mark.identity.inode >> mark.identity.bytes >> mark.identity.changed_ns >> since &&
         std::getline(text >> std::ws, path)) {
    mark.since = utcFromNs(since);
    marks[path] = mark;
  }
  return marks;
}

void writeMarks(FileOps& files, const fs::path& archive, const Marks& marks) {
  std::ostringstream text;
  for (const auto& [path, mark] : marks)
    if (path.find('\n') == std::string::npos)  // such a file is marked anew each time, and stays
      text << mark.identity.inode << ' ' << mark.identity.bytes << ' ' << mark.identity.changed_ns
           << ' ' << toNs(mark.since) << ' ' << path << '\n';
  writeWhole(files, marksPath(archive), text.str());
}

}  // namespace patina::db::care
