// SPDX-License-Identifier: GPL-3.0-or-later
// The system itself fails: below FileOps and below SQLite's own files, where EINTR and close() are.
// A program that links this has the C library's open, pwrite, fsync, rename, close and statvfs
// replaced by ones that count and, when told, fail.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

namespace patina::testing {

// While one lives, calls on what lies in its folder count, from 1. One at a time, one thread.
class FailingSystemCalls {
 public:
  explicit FailingSystemCalls(const std::filesystem::path& folder);
  ~FailingSystemCalls();
  FailingSystemCalls(const FailingSystemCalls&) = delete;
  FailingSystemCalls& operator=(const FailingSystemCalls&) = delete;

  static constexpr int kShortWrite = -1;  // an `error`: a write takes half of its bytes
  // Once. A failing call is not made, but for close(): Linux closes whatever it answers.
  void failCall(std::int64_t k, int error);
  std::int64_t calls() const { return calls_; }
  const std::string& failed() const { return failed_; }  // the name of the call that did; or empty
  // Syncs of a descriptor that had failed to sync with EIO, and was not closed since.
  std::int64_t syncsAfterFailure() const { return syncs_after_failure_; }

  // For the replaced calls. The errno to answer; 0: make the call; kShortWrite: half of it.
  int onPath(const char* call, const char* path);
  int onDescriptor(const char* call, int fd);
  void opened(int fd, const char* path);
  void synced(int fd, int error);
  void closed(int fd);

 private:
  bool covers(const char* path) const;
  int count(const char* call);

  std::string prefix_;
  std::int64_t calls_ = 0, fail_at_ = 0, syncs_after_failure_ = 0;
  int error_ = 0;
  std::string failed_;
  std::set<int> open_, spoilt_;
};

}  // namespace patina::testing
