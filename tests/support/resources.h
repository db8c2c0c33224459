// SPDX-License-Identifier: GPL-3.0-or-later
// What a running process takes, read from outside.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace patina::testing {

struct Resources {
  double resident_bytes = 0, wal_bytes = 0;
  int descriptors = 0;
};

// VmRSS of /proc/PID/status; nothing when the process is gone, also while nobody has waited for it.
inline std::optional<double> residentBytes(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == "VmRSS:" && status >> kilobytes) return 1024 * kilobytes;
  }
  return std::nullopt;
}

inline bool isAlive(pid_t process) { return residentBytes(process).has_value(); }

// Processes that a process has started and not yet waited for.
inline std::vector<pid_t> childrenOf(pid_t process) {
  std::vector<pid_t> children;
  std::error_code error;
  const std::filesystem::path threads = "/proc/" + std::to_string(process) + "/task";
  for (std::filesystem::directory_iterator thread(threads, error), end; !error && thread != end;
       thread.increment(error)) {
    std::ifstream in(thread->path() / "children");
    for (pid_t child = 0; in >> child;) children.push_back(child);
  }
  return children;
}

// What its descriptors lead to: "socket:[4711]", a path.
inline std::vector<std::string> descriptorsOf(pid_t process) {
  std::vector<std::string> targets;
  std::error_code error;
  const std::filesystem::path open = "/proc/" + std::to_string(process) + "/fd";
  for (std::filesystem::directory_iterator fd(open, error), end; !error && fd != end;
       fd.increment(error)) {
    std::error_code gone;
    targets.push_back(fd->path().filename().string() + " " +
                      std::filesystem::read_symlink(fd->path(), gone).string());
  }
  return targets;
}

// `archive` is the one whose WAL is measured.
inline std::optional<Resources> resourcesOf(pid_t process, const std::filesystem::path& archive) {
  const auto resident = residentBytes(process);
  if (!resident) return std::nullopt;
  Resources taken;
  taken.resident_bytes = *resident;
  taken.descriptors = static_cast<int>(descriptorsOf(process).size());
  std::error_code error;
  const auto wal = std::filesystem::file_size(archive / "catalog.sqlite-wal", error);
  taken.wal_bytes = error ? 0 : static_cast<double>(wal);
  return taken;
}

}  // namespace patina::testing
