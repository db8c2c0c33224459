// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/lock.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>

#include "db/errors.h"
#include "processing/image/units.h"

namespace patina::db {
namespace {

std::string hostName() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "?";
  return name.data();
}

// The lock file is written once, when it is taken: its time is "since".
std::string describeOwner(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string what, who;
  std::getline(file, what);
  std::getline(file, who);
  if (what.empty()) return "another process";
  std::string text = "'" + what + "' (" + who;
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0)
    text += ", since " +
            formatUtc(utcFromNs(status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec));
  return text + ")";
}

void refuse(const std::filesystem::path& archive, const std::string& why) {
  throw ArchiveError(Exit::kCannotCreate, "the file system of " + archive.string() + " " + why +
                                              ": keep the archive on a local disk");
}

}  // namespace

namespace {

std::unique_ptr<FileLock> take(FileOps& files, const std::filesystem::path& archive,
                               const std::filesystem::path& path, const std::string& owner) {
  std::unique_ptr<FileLock> lock;
  const int got = files.lock(path, &lock);
  if (got == -EWOULDBLOCK)
    throw ArchiveError(Exit::kTemporary, "archive " + archive.string() + " is in use by " +
                                             describeOwner(path) +
                                             ": wait for it, stop it, or use another archive");
  if (got == -ENOLCK || got == -EOPNOTSUPP || got == -ENOSYS || got == -EINVAL)
    refuse(archive, "has no locks");
  checkDisk(got, "locking", path);

  std::unique_ptr<File> file;
  checkDisk(files.open(path, FileOps::Mode::kUpdate, &file), "opening", path);
  std::ostringstream text;
  text << (owner.empty() ? "patina" : owner) << "\npid " << ::getpid() << " on " << hostName()
       << "\n";
  const std::string content = text.str();
  checkDisk(file->write(std::as_bytes(std::span(content)), 0), "writing", path);
  checkDisk(file->truncate(static_cast<std::int64_t>(content.size())), "writing", path);
  return lock;
}

}  // namespace

std::unique_ptr<FileLock> takeLock(FileOps& files, const std::filesystem::path& archive,
                                   const std::string& owner) {
  return take(files, archive, archive / "lock", owner);
}

std::unique_ptr<FileLock> takeCareLock(FileOps& files, const std::filesystem::path& archive,
                                       const std::string& owner) {
  const auto folder = archive / "care";
  const int made = files.makeFolder(folder);
  if (made != -EEXIST) checkDisk(made, "making", folder);
  return take(files, archive, folder / "lock", owner);
}

void probeFileSystem(FileOps& files, const std::filesystem::path& archive, bool allow_network) {
  if (!allow_network && files.isNetwork(archive) == 1)
    refuse(archive, "is a network file system, whose locks and caches cannot be trusted");

  const auto a = archive / "tmp" / "probe-a", b = archive / "tmp" / "probe-b";
  const auto create = [&](const std::filesystem::path& path) {
    std::unique_ptr<File> file;
    files.remove(path);  // left by a process that died here
    checkDisk(files.open(path, FileOps::Mode::kCreate, &file), "creating", path);
  };
  create(a);
  files.remove(b);
  const int first = files.renameNoReplace(a, b);
  if (first == -EINVAL || first == -ENOSYS || first == -EOPNOTSUPP)
    refuse(archive, "cannot rename without replacing");
  checkDisk(first, "renaming", a);
  create(a);
  if (files.renameNoReplace(a, b) != -EEXIST)
    refuse(archive, "replaces a file by a rename that must not");
  const int synced = files.syncFolder(archive / "tmp");
  if (synced == -EINVAL || synced == -ENOSYS || synced == -EOPNOTSUPP || synced == -EBADF)
    refuse(archive, "cannot sync a folder");
  checkDisk(synced, "syncing", archive / "tmp");
  checkDisk(files.remove(a), "removing", a);
  checkDisk(files.remove(b), "removing", b);
}

}  // namespace patina::db
