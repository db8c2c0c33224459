// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon: one archive, its runs, its front door.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "db/archive.h"
#include "devices/clock.h"

namespace patina::daemon {

struct DaemonOptions {
  std::filesystem::path archive;
  std::string command;  // as typed: the owner that a second daemon is told of
  std::string version;
  std::filesystem::path config;                   // daemon.toml; empty: defaults
  std::filesystem::path plans;                    // above the file's
  std::optional<int> port;                        // the same
  double speed = 0;                               // of a rehearsal; 0: real time, real devices
  std::filesystem::path start;                    // a plan to start, or go on with, at once
  std::vector<std::string> after_command;         // makes the products of the run named behind it
  std::string log_acks;                           // of AckLog
  std::function<void(const std::string&)> say;    // one line for people, any thread
  std::function<void(db::CommitPoint)> at_point;  // of ArchiveOptions: may not return
};

class Daemon {
 public:
  // Owns the archive and listens when this returns. Throws db::ArchiveError (kTemporary, naming the
  // owner, when another process has the archive), devices::ConfigError, http::HttpError.
  Daemon(const DaemonOptions& options, devices::Clock& real);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // Takes up what was left unfinished and keeps it going until it is told to stop: then frames are
  // finished, and runs left to go on. db::ArchiveError(kIo) when the disk failed: start again.
  void run(const std::stop_token& stop);
  // Any thread: SIGHUP. What changed, or why nothing did.
  std::string reload();
  int port() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace patina::daemon
