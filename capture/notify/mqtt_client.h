// SPDX-License-Identifier: GPL-3.0-or-later
// A connection to an MQTT broker that comes back by itself. Hides libmosquitto, whose own thread
// keeps the connection; everything here is called from one other thread.
#pragma once

#include <memory>
#include <string>

#include "capture/alert_settings.h"
#include "capture/notify/notifier.h"

namespace patina::capture::notify {

struct MqttTopic {
  std::string topic, payload;
  bool retain = true;
};

class MqttClient {
 public:
  // `will`: what the broker says for us when we are gone without a word; no topic: nothing.
  MqttClient(const MqttSettings& settings, std::string password, MqttTopic will);
  ~MqttClient();  // says goodbye
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  // Connected, or why not yet.
  Delivery connect(Nanoseconds limit, const std::stop_token& hurry);
  // Rises with every connection: what was said before it may be gone.
  int connection() const;
  // In order, each at least once; answers when the broker has them all.
  Delivery publish(const std::vector<MqttTopic>& topics, Nanoseconds limit,
                   const std::stop_token& hurry);

  struct State;

 private:
  Delivery begin();
  MqttSettings settings_;
  std::string password_;
  MqttTopic will_;
  std::unique_ptr<State> state_;  // nothing until connect(), and after a connection that failed
  int connections_before_ = 0;
};

}  // namespace patina::capture::notify
