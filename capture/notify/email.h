// SPDX-License-Identifier: GPL-3.0-or-later
// A message as mail, handed to the machine's own sendmail: it queues, and knows where mail goes.
#pragma once

#include <filesystem>

#include "capture/alert_settings.h"
#include "capture/notify/notifier.h"

namespace patina::capture::notify {

// Headers and body as sendmail takes them on its standard input. Every header is made of what the
// plan's reader has checked, or of printable ASCII: no message can add one.
std::string mailOf(const Message& message, const EmailSettings& settings);

class Email final : public Notifier {
 public:
  explicit Email(EmailSettings settings, std::filesystem::path sendmail = "/usr/sbin/sendmail",
                 Nanoseconds limit = std::chrono::seconds(20));
  const std::string& name() const override { return name_; }
  bool wants(const Message& message) const override;
  Nanoseconds pause() const override { return {}; }
  // No shell: the program itself, with -i -t, a plain environment and no descriptor but its three.
  // One that hangs is killed.
  Delivery send(const Message& message, const std::stop_token& hurry) override;

 private:
  EmailSettings settings_;
  std::filesystem::path sendmail_;
  Nanoseconds limit_;
  std::string name_;
};

}  // namespace patina::capture::notify
