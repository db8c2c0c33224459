// SPDX-License-Identifier: GPL-3.0-or-later
// A real mosquitto on a port of loopback, and somebody who listens to it.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "capture/alert_settings.h"
#include "tests/support/temp_folder.h"

struct mosquitto;
struct mosquitto_message;

namespace patina::testing {

class Broker {
 public:
  static bool installed();
  // `config`: more lines; anonymous clients are let in unless it says otherwise.
  explicit Broker(std::string config = "allow_anonymous true");
  ~Broker();
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  void stop();
  void start();  // on the same port; forgets what it held
  capture::MqttSettings settings() const;
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_ = TempFolder::inMemory();
  int port_;
  pid_t pid_ = 0;
};

class Listener {
 public:
  explicit Listener(const capture::MqttSettings& broker, const std::string& filter = "#");
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // Blocks until the topic says so.
  void waitFor(const std::string& topic, const std::string& payload);
  std::string waitForAny(const std::string& topic);
  std::map<std::string, std::string> newest() const;  // by topic
  int retained() const;  // how many came as retained: before this listener was there

 private:
  static void onConnect(mosquitto* client, void* user, int code);
  static void onSubscribe(mosquitto* client, void* user, int id, int count, const int* qos);
  static void onMessage(mosquitto* client, void* user, const mosquitto_message* message);
  std::string filter_;
  mosquitto* client_;
  mutable std::mutex mutex_;
  std::condition_variable came_;
  bool subscribed_ = false;
  int retained_ = 0;
  std::map<std::string, std::string> newest_;
};

}  // namespace patina::testing

#define PATINA_BROKER_OR_SKIP() \
  if (!::patina::testing::Broker::installed()) GTEST_SKIP() << "mosquitto is not installed"
