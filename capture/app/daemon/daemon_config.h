// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's own file, and what of it may change while it runs.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace patina::daemon {

struct DaemonConfig {
  std::filesystem::path plans;       // where plans that the network may start lie; empty: none
  std::string listen = "127.0.0.1";  // the rest takes a restart
  int port = 8460;                   // 0: any free one
  bool behind_proxy = false;         // a proxy brings TLS
  std::filesystem::path tls_certificate, tls_key;
  std::vector<std::string> host_names;  // under which browsers may come
};

// daemon.toml. Throws devices::ConfigError: file, line, key, allowed range. An empty path gives the
// defaults.
DaemonConfig readDaemonConfig(const std::filesystem::path& file);
DaemonConfig parseDaemonConfig(const std::string& toml, const std::filesystem::path& source);

// Thread-safe.
class LiveConfig {
 public:
  // `plans`, when not empty, stands above the file's.
  LiveConfig(std::filesystem::path file, std::filesystem::path plans);
  DaemonConfig get() const;
  // Reads the file again. What it changes, in words. Throws, and changes nothing, when the file is
  // wrong or asks for what only a restart can give.
  std::string reload();

 private:
  DaemonConfig read() const;
  const std::filesystem::path file_, plans_;
  mutable std::mutex mutex_;
  DaemonConfig config_;
};

}  // namespace patina::daemon
