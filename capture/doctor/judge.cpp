// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/doctor/judge.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace patina::doctor {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kMiB = 1 << 20;

std::string millis(Nanoseconds d) { return std::to_string(d.count() / 1'000'000) + " ms"; }

void judgeFileSystem(const ArchiveFacts& a, std::vector<Finding>& out) {
  const std::string where = a.there.string() + " is " + a.file_system;
  const auto any_of = [&a](auto... names) { return ((a.file_system == names) || ...); };
  if (!a.refused.empty())
    out.push_back({"file system", Level::kFail, where + ": " + a.refused,
                   "keep the archive on a local disk; back it up to the network"});
  else if (any_of("tmpfs", "ramfs"))
    out.push_back({"file system", Level::kWarn, where + ": in memory, gone with the power",
                   "name a folder on a disk, unless this is a rehearsal"});
  else if (any_of("vfat", "exfat", "ntfs", "fuse"))
    out.push_back({"file system", Level::kWarn, where + ": it does not survive a power cut well",
                   "format the disk as ext4 or xfs"});
  else
    out.push_back({"file system", Level::kOk, where, ""});
}

void judgeAccess(const ArchiveFacts& a, std::vector<Finding>& out) {
  if (a.read_only)
    out.push_back({"permissions", Level::kFail, a.there.string() + " is mounted read-only",
                   "mount it writable: `mount -o remount,rw`; look into `dmesg` for disk errors"});
  else if (!a.writable)
    out.push_back({"permissions", Level::kFail, "we may not write to " + a.there.string(),
                   "give the user of the run the folder: `chown`"});
  else
    out.push_back({"permissions", Level::kOk, a.there.string() + " can be written", ""});
  if (!a.is_archive)
    out.push_back({"lock", Level::kOk, "no archive there yet", ""});
  else if (a.locked_by.empty())
    out.push_back({"lock", Level::kOk, "nobody captures into the archive", ""});
  else
    out.push_back({"lock", Level::kWarn, "the archive is in use by " + a.locked_by,
                   "a second run needs another archive, or waits"});
}

void judgeSpace(const ArchiveFacts& a, std::vector<Finding>& out) {
  if (!a.free_bytes || !a.total_bytes || *a.total_bytes == 0) return;
  const double share = static_cast<double>(*a.free_bytes) / static_cast<double>(*a.total_bytes);
  const std::string what = formatBytes(*a.free_bytes) + " free, " +
                           std::to_string(static_cast<int>(share * 100)) + " % of the disk";
  const std::string advice = "make room; `patina plan check` says how much a plan needs";
  constexpr double kSoft = 0.10, kHard = 0.02;
  const Level level = share < kHard ? Level::kFail : share < kSoft ? Level::kWarn : Level::kOk;
  out.push_back({"disk space", level, what, level == Level::kOk ? "" : advice});
  if (!a.free_files || !a.total_files || *a.total_files == 0) return;
  if (static_cast<double>(*a.free_files) < kHard * static_cast<double>(*a.total_files))
    out.push_back({"disk files", Level::kFail,
                   "only " + std::to_string(*a.free_files) + " more files fit on the disk",
                   "each frame is a file: remove small files, or format with more inodes"});
}

void judgeSpeed(const ArchiveFacts& a, std::vector<Finding>& out) {
  if (!a.probe_failed.empty()) {
    out.push_back({"disk speed", Level::kFail, a.probe_failed,
                   "a run would end the same way: put this right first"});
    return;
  }
  if (!a.commit_median || !a.commit_worst) return;
  const std::string what = "a frame is safe on the disk after " + millis(*a.commit_median) +
                           " (median), " + millis(*a.commit_worst) + " at worst";
  constexpr Nanoseconds kSlow = 250ms, kTooSlow = 2s;
  const Level level = *a.commit_median > kTooSlow                              ? Level::kFail
                      : *a.commit_median > kSlow || *a.commit_worst > kTooSlow ? Level::kWarn
                                                                               : Level::kOk;
  out.push_back({"disk speed", level, what,
                 level == Level::kOk ? "" : "use a faster disk, or an interval that is longer"});
}

}  // namespace

const char* name(Level level) {
  constexpr std::array<const char*, 3> kNames = {"ok", "warn", "fail"};
  return kNames[static_cast<std::size_t>(level)];
}

std::vector<Finding> judge(const MachineFacts& m) {
  std::vector<Finding> out;
  if (m.clock_synchronised && *m.clock_synchronised)
    out.push_back({"clock", Level::kOk, "synchronised", ""});
  else
    out.push_back({"clock", Level::kWarn, "wall time is not synchronised: labels of steps may jump",
                   "start a time service: `apt install chrony`, or systemd-timesyncd"});
  const bool can_sleep = std::ranges::any_of(
      m.sleep_states, [](std::string_view s) { return s == "mem" || s == "disk"; });
  if (can_sleep && !m.unmasked_sleep.empty()) {
    std::string names;
    for (const std::string& n : m.unmasked_sleep) names += " " + n;
    out.push_back({"suspend", Level::kWarn, "the machine can be put to sleep in mid run",
                   "`systemctl mask" + names + "`"});
  } else {
    out.push_back({"suspend", Level::kOk, can_sleep ? "masked" : "the machine cannot sleep", ""});
  }
  if (m.memory_free_bytes) {
    const Level level = *m.memory_free_bytes < 128 * kMiB   ? Level::kFail
                        : *m.memory_free_bytes < 512 * kMiB ? Level::kWarn
                                                            : Level::kOk;
    out.push_back(
        {"memory", level, formatBytes(*m.memory_free_bytes) + " available",
         level == Level::kOk ? "" : "end other programs, or raise the limit of the unit"});
  }
  if (m.descriptors) {
    const Level level = *m.descriptors < 128    ? Level::kFail
                        : *m.descriptors < 1024 ? Level::kWarn
                                                : Level::kOk;
    out.push_back({"descriptors", level,
                   "a process may open " + std::to_string(*m.descriptors) + " files",
                   level == Level::kOk ? "" : "`ulimit -n 4096`, or LimitNOFILE= of the unit"});
  }
  return out;
}

std::vector<Finding> judge(const ArchiveFacts& a) {
  std::vector<Finding> out;
  judgeFileSystem(a, out);
  judgeAccess(a, out);
  judgeSpace(a, out);
  judgeSpeed(a, out);
  return out;
}

}  // namespace patina::doctor
