// SPDX-License-Identifier: GPL-3.0-or-later
// The channels that a plan names.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "capture/alert_settings.h"
#include "capture/notify/mqtt.h"

namespace patina::capture::notify {

struct Channels {
  std::vector<std::unique_ptr<Notifier>> open;
  std::vector<std::string> problems;  // one a channel that cannot be made; the others work
};

constexpr const char* kSendmail = "/usr/sbin/sendmail";

Channels openChannels(const AlertSettings& settings, const About& about, const Inventory& inventory,
                      Mqtt::Purpose purpose, const std::filesystem::path& sendmail = kSendmail);

}  // namespace patina::capture::notify
