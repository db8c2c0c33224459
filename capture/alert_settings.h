// SPDX-License-Identifier: GPL-3.0-or-later
// The plan's [alerts]: what is told, when, and through which channels. Only names and places stand
// in a plan, for it is kept in the archive for all to read: what is secret lies in files of its
// own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/alerts.h"
#include "devices/config_file.h"

namespace patina::capture {

using SecretFile = std::optional<std::filesystem::path>;  // read by who uses it, never logged

struct WebhookSettings {            // a POST of JSON
  std::string url;                  // empty: url_file has it
  SecretFile url_file, token_file;  // the token: "Authorization: Bearer ..."
  Severity least = Severity::kWarning;
};
struct EmailSettings {  // through /usr/sbin/sendmail
  std::vector<std::string> to;
  std::string from;  // empty: whom sendmail takes it to be from
  Severity least = Severity::kWarning;
};
struct MqttSettings {
  std::string host = "localhost";
  int port = 1883;
  std::string user;
  SecretFile password_file;
  bool tls = false;
  std::optional<std::filesystem::path> ca_file;  // default: those of the system
  std::string topic = "patina";                  // patina/<specimen>/...
  std::string discovery = "homeassistant";       // prefix of Home Assistant; empty: none
};
struct HeartbeatSettings {  // a GET after a frame, at most once a minute
  std::string url;
  SecretFile url_file;
};

struct AlertSettings {
  AlertRules rules;
  std::vector<WebhookSettings> webhooks;
  std::optional<EmailSettings> email;
  std::optional<MqttSettings> mqtt;
  std::optional<HeartbeatSettings> heartbeat;

  bool anyChannel() const { return !webhooks.empty() || email || mqtt || heartbeat; }
};

// Throws devices::ConfigError.
AlertSettings takeAlerts(devices::ConfigTable& plan, Nanoseconds interval);

}  // namespace patina::capture
