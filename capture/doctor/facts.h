// SPDX-License-Identifier: GPL-3.0-or-later
// What the doctor knows of machine and archive; what it could not find out is nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::doctor {

struct MachineFacts {
  std::optional<bool> clock_synchronised;
  std::vector<std::string> sleep_states;           // of /sys/power/state: "mem" "disk"
  std::vector<std::string> unmasked_sleep;         // systemd targets that can still put it to sleep
  std::optional<std::uint64_t> memory_free_bytes;  // available, within the limit of our group
  std::optional<std::uint64_t> descriptors;        // that we may open
};
// `root` stands for / : /proc, /sys and /etc lie below it.
MachineFacts machineFacts(const std::filesystem::path& root = "/");

struct ArchiveFacts {
  std::filesystem::path folder;  // as asked for
  std::filesystem::path there;   // it, or as much of its path as exists
  std::string file_system;       // "ext4" "tmpfs" "nfs" ...
  bool read_only = false, writable = true;
  bool is_archive = false;
  std::string locked_by;  // the owner in its lock, when another process has it
  std::string refused;    // why db/ would not work on this file system
  std::optional<std::uint64_t> free_bytes, total_bytes;
  std::optional<std::uint64_t> free_files, total_files;  // inodes
  std::string probe_failed;                              // why there is no latency
  std::optional<Nanoseconds> commit_median, commit_worst;
};
ArchiveFacts archiveFacts(const std::filesystem::path& archive);

}  // namespace patina::doctor
