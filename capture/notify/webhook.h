// SPDX-License-Identifier: GPL-3.0-or-later
// A message as a POST of JSON (message.h: jsonOf).
#pragma once

#include "capture/alert_settings.h"
#include "capture/notify/notifier.h"

namespace patina::capture::notify {

class Webhook final : public Notifier {
 public:
  explicit Webhook(const WebhookSettings& settings);  // NotifyError: a secret is not there
  const std::string& name() const override { return name_; }
  bool wants(const Message& message) const override;
  Nanoseconds pause() const override { return {}; }
  Delivery send(const Message& message, const std::stop_token& hurry) override;

 private:
  std::string url_, token_, name_;
  Severity least_;
};

}  // namespace patina::capture::notify
