// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/daemon_config.h"

#include <tuple>

#include "capture/failure.h"
#include "devices/config_file.h"

namespace patina::daemon {
namespace {

std::string toldOf(const DaemonConfig& was, const DaemonConfig& is) {
  if (was.plans == is.plans) return "nothing has changed";
  return "plans of the network: " + (is.plans.empty() ? "none" : is.plans.string());
}

}  // namespace

DaemonConfig readDaemonConfig(const std::filesystem::path& file) {
  if (file.empty()) return {};
  return parseDaemonConfig(devices::ConfigFile::readText(file), file);
}

DaemonConfig parseDaemonConfig(const std::string& toml, const std::filesystem::path& source) {
  DaemonConfig config;
  devices::ConfigTable table = devices::ConfigFile::parse(toml, source);
  config.plans = table.takePath("plans", std::filesystem::path());
  config.listen = table.takeString("listen", config.listen);
  config.port = static_cast<int>(table.takeInteger("port", 0, 65535, config.port));
  config.behind_proxy = table.takeBool("behind_proxy", false);
  config.tls_certificate = table.takePath("tls_certificate", std::filesystem::path());
  config.tls_key = table.takePath("tls_key", std::filesystem::path());
  config.host_names = table.takeStrings("host_names", std::vector<std::string>());
  table.finish();
  std::error_code error;
  if (!config.plans.empty() && !std::filesystem::is_directory(config.plans, error))
    table.reject("plans", config.plans.string() + " is no folder");
  if (config.tls_certificate.empty() != config.tls_key.empty())
    table.reject("tls_key", "tls_certificate and tls_key come together");
  return config;
}

LiveConfig::LiveConfig(std::filesystem::path file, std::filesystem::path plans)
    : file_(std::move(file)), plans_(std::move(plans)), config_(read()) {}

DaemonConfig LiveConfig::read() const {
  DaemonConfig config = readDaemonConfig(file_);
  if (!plans_.empty()) config.plans = plans_;
  return config;
}

DaemonConfig LiveConfig::get() const {
  const std::lock_guard lock(mutex_);
  return config_;
}

std::string LiveConfig::reload() {
  const DaemonConfig fresh = read();
  const std::lock_guard lock(mutex_);
  const auto fixed = [](const DaemonConfig& c) {
    return std::tie(c.listen, c.port, c.behind_proxy, c.tls_certificate, c.tls_key, c.host_names);
  };
  if (fixed(fresh) != fixed(config_))
    throw capture::CaptureError(Exit::kConfig,
                                file_.string() +
                                    ": only `plans` can change while the daemon runs: restart it "
                                    "for the rest, runs go on by themselves");
  std::string told = toldOf(config_, fresh);
  config_ = fresh;
  return told;
}

}  // namespace patina::daemon
