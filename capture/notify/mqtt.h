// SPDX-License-Identifier: GPL-3.0-or-later
// The rig on an MQTT broker: retained state topics, a last will, Home Assistant discovery.
#pragma once

#include <map>
#include <set>
#include <string>

#include "capture/notify/home_assistant.h"
#include "capture/notify/mqtt_client.h"

namespace patina::capture::notify {

class Mqtt final : public Notifier {
 public:
  enum class Purpose {
    kRun,
    kTest  // says nothing of any run and leaves nothing behind
  };
  // NotifyError: the password is not there.
  Mqtt(const MqttSettings& settings, About about, Inventory inventory, Purpose purpose);
  ~Mqtt() override;  // "offline"
  const std::string& name() const override { return name_; }
  bool wants(const Message& message) const override;
  Nanoseconds pause() const override { return std::chrono::seconds(10); }
  Delivery send(const Message& message, const std::stop_token& hurry) override;

 private:
  void takeIn(const Message& message);
  void set(const std::string& topic, const std::string& payload);
  std::string base() const { return settings_.topic + "/" + about_.specimen; }

  MqttSettings settings_;
  About about_;
  Inventory inventory_;
  Purpose purpose_;
  std::string name_;
  MqttClient client_;
  std::map<std::string, std::string> retained_;      // all that is known, by topic
  std::set<std::string> changed_;                    // of it, what the broker may not have yet
  std::map<AlertKind, std::set<std::string>> told_;  // conditions that are on, with their subjects
  int connection_ = 0;                               // the one that has everything
};

}  // namespace patina::capture::notify
