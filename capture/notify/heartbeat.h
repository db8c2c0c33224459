// SPDX-License-Identifier: GPL-3.0-or-later
// A GET after a frame was acknowledged: whoever counts the beats misses them when frames stop,
// whatever stopped them. An alarm that needs nobody here alive.
#pragma once

#include "capture/alert_settings.h"
#include "capture/notify/notifier.h"

namespace patina::capture::notify {

class Heartbeat final : public Notifier {
 public:
  explicit Heartbeat(const HeartbeatSettings& settings);  // NotifyError: a secret is not there
  const std::string& name() const override { return name_; }
  bool wants(const Message& message) const override;
  Nanoseconds pause() const override { return std::chrono::minutes(1); }
  Delivery send(const Message& message, const std::stop_token& hurry) override;

 private:
  std::string url_, name_;
};

}  // namespace patina::capture::notify
