// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/file.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <utility>

#include "capture/doctor/facts.h"
#include "db/file_ops.h"

namespace patina::doctor {
namespace {

namespace fs = std::filesystem;

std::string fileSystemName(std::uint32_t magic) {
  // linux/magic.h and statfs(2).
  constexpr std::array<std::pair<std::uint32_t, const char*>, 18> kNames = {{
      {0xEF53, "ext4"},
      {0x58465342, "xfs"},
      {0x9123683E, "btrfs"},
      {0x2FC12FC1, "zfs"},
      {0xF2F52010, "f2fs"},
      {0x01021994, "tmpfs"},
      {0x858458F6, "ramfs"},
      {0x794C7630, "overlay"},
      {0x4D44, "vfat"},
      {0x2011BAB0, "exfat"},
      {0x7366746E, "ntfs"},
      {0x65735546, "fuse"},
      {0x6969, "nfs"},
      {0xFF534D42, "cifs"},
      {0xFE534D42, "smb"},
      {0x01021997, "9p"},
      {0x73717368, "squashfs"},
      {0x00C36400, "ceph"},
  }};
  for (const auto& [known, name] : kNames)
    if (known == magic) return name;
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%x", magic);
  return text.data();
}

// Who owns the archive, when its lock is taken. Only asks; a lock we get is given back at once.
std::string ownerOf(const fs::path& archive) {
  const fs::path path = archive / "lock";
  if (!fs::exists(path)) return {};
  std::unique_ptr<db::FileLock> lock;
  if (db::realFileOps().lock(path, &lock) != -EWOULDBLOCK) return {};
  std::ifstream file(path);
  std::string what, who;
  std::getline(file, what);
  std::getline(file, who);
  return what.empty() ? "another process" : what + " (" + who + ")";
}

}  // namespace

ArchiveFacts archiveFacts(const fs::path& archive) {
  ArchiveFacts facts;
  facts.folder = facts.there = fs::absolute(archive).lexically_normal();
  std::error_code error;
  while (!fs::exists(facts.there, error) && facts.there.has_relative_path())
    facts.there = facts.there.parent_path();
  facts.is_archive = fs::exists(facts.folder / "catalog.sqlite", error);
  struct statfs kind {};
  if (::statfs(facts.there.c_str(), &kind) == 0)
    facts.file_system = fileSystemName(static_cast<std::uint32_t>(kind.f_type));
  struct statvfs space {};
  if (::statvfs(facts.there.c_str(), &space) == 0) {
    facts.read_only = (space.f_flag & ST_RDONLY) != 0;
    facts.free_bytes = static_cast<std::uint64_t>(space.f_bavail) * space.f_frsize;
    facts.total_bytes = static_cast<std::uint64_t>(space.f_blocks) * space.f_frsize;
    if (space.f_files > 0) {
      facts.free_files = space.f_favail;
      facts.total_files = space.f_files;
    }
  }
  facts.writable = !facts.read_only && ::access(facts.there.c_str(), W_OK | X_OK) == 0;
  if (db::realFileOps().isNetwork(facts.there) == 1)
    facts.refused = "a network file system, whose locks and caches cannot be trusted";
  if (facts.is_archive && facts.writable) facts.locked_by = ownerOf(facts.folder);
  return facts;
}

}  // namespace patina::doctor
