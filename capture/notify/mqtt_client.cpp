// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/mqtt_client.h"

#include <mosquitto.h>

#include <mutex>
#include <set>

#include "capture/notify/wait.h"

namespace patina::capture::notify {
namespace {

constexpr int kKeepAliveSeconds = 30;
constexpr unsigned kReconnectLeastSeconds = 1, kReconnectMostSeconds = 30;
constexpr int kAtLeastOnce = 1;

Delivery tryAgain(const std::string& why) { return {Delivery::Result::kTryAgain, why}; }

}  // namespace

struct MqttClient::State {
  mosquitto* client = nullptr;
  bool looping = false;
  Bell bell;
  std::mutex mutex;  // below: written by the library's thread
  bool connected = false;
  int connections = 0;
  std::string trouble;
  std::set<int> taken;  // ids of messages that the broker has

  ~State() {
    if (client == nullptr) return;
    mosquitto_disconnect(client);
    if (looping) mosquitto_loop_stop(client, false);
    mosquitto_destroy(client);
  }

  static void onConnect(mosquitto*, void* user, int code) {
    auto& self = *static_cast<State*>(user);
    {
      const std::lock_guard lock(self.mutex);
      self.connected = code == 0;
      self.trouble = code == 0 ? "" : mosquitto_connack_string(code);
      if (code == 0) ++self.connections;
    }
    self.bell.ring();
  }
  static void onDisconnect(mosquitto*, void* user, int code) {
    auto& self = *static_cast<State*>(user);
    {
      const std::lock_guard lock(self.mutex);
      self.connected = false;
      if (self.trouble.empty() && code != 0) self.trouble = mosquitto_strerror(code);
    }
    self.bell.ring();
  }
  static void onPublish(mosquitto*, void* user, int id) {
    auto& self = *static_cast<State*>(user);
    {
      const std::lock_guard lock(self.mutex);
      self.taken.insert(id);
    }
    self.bell.ring();
  }
};

MqttClient::MqttClient(const MqttSettings& settings, std::string password, MqttTopic will)
    : settings_(settings), password_(std::move(password)), will_(std::move(will)) {}

MqttClient::~MqttClient() = default;

int MqttClient::connection() const {
  if (!state_) return connections_before_;
  const std::lock_guard lock(state_->mutex);
  return connections_before_ + state_->connections;
}

Delivery MqttClient::begin() {
  static const int ready = mosquitto_lib_init();
  auto state = std::make_unique<State>();
  // Without an id of its own: two runs on one broker would throw each other out.
  if (ready == MOSQ_ERR_SUCCESS) state->client = mosquitto_new(nullptr, true, state.get());
  if (state->client == nullptr) return tryAgain("out of memory");
  mosquitto* const client = state->client;
  mosquitto_connect_callback_set(client, State::onConnect);
  mosquitto_disconnect_callback_set(client, State::onDisconnect);
  mosquitto_publish_callback_set(client, State::onPublish);
  mosquitto_reconnect_delay_set(client, kReconnectLeastSeconds, kReconnectMostSeconds, true);
  int code = MOSQ_ERR_SUCCESS;
  if (!settings_.user.empty())
    code = mosquitto_username_pw_set(client, settings_.user.c_str(),
                                     password_.empty() ? nullptr : password_.c_str());
  if (code == MOSQ_ERR_SUCCESS && settings_.tls)
    code = mosquitto_tls_set(client, settings_.ca_file ? settings_.ca_file->c_str() : nullptr,
                             settings_.ca_file ? nullptr : "/etc/ssl/certs", nullptr, nullptr,
                             nullptr);
  if (code == MOSQ_ERR_SUCCESS && !will_.topic.empty())
    code = mosquitto_will_set(client, will_.topic.c_str(), static_cast<int>(will_.payload.size()),
                              will_.payload.data(), kAtLeastOnce, will_.retain);
  if (code != MOSQ_ERR_SUCCESS) return {Delivery::Result::kRefused, mosquitto_strerror(code)};
  code = mosquitto_connect_async(client, settings_.host.c_str(), settings_.port, kKeepAliveSeconds);
  if (code == MOSQ_ERR_ERRNO || code == MOSQ_ERR_EAI)
    return tryAgain("no connection to " + settings_.host + ":" + std::to_string(settings_.port));
  if (code == MOSQ_ERR_SUCCESS) code = mosquitto_loop_start(client);
  if (code != MOSQ_ERR_SUCCESS) return tryAgain(mosquitto_strerror(code));
  state->looping = true;
  state_ = std::move(state);
  return {};
}

Delivery MqttClient::connect(Nanoseconds limit, const std::stop_token& hurry) {
  if (!state_)
    if (Delivery begun = begin(); !begun.delivered()) return begun;
  Wait wait(limit);
  for (;;) {
    state_->bell.hush();
    std::string trouble;
    {
      const std::lock_guard lock(state_->mutex);
      if (state_->connected) return {};
      trouble = state_->trouble;
    }
    const Waited waited = wait.untilReadable(state_->bell.fd(), hurry);
    if (waited == Waited::kReady && trouble.empty()) continue;
    // The library's thread gives up for good on some errors, a name that is not found among them:
    // the next try begins from nothing.
    connections_before_ = connection();
    state_.reset();
    return tryAgain("no connection to " + settings_.host + ":" + std::to_string(settings_.port) +
                    (trouble.empty() ? " within " + formatDuration(limit) : ": " + trouble));
  }
}

Delivery MqttClient::publish(const std::vector<MqttTopic>& topics, Nanoseconds limit,
                             const std::stop_token& hurry) {
  if (!state_) return tryAgain("not connected");
  std::set<int> waiting;
  for (const MqttTopic& t : topics) {
    int id = 0;
    const int code =
        mosquitto_publish(state_->client, &id, t.topic.c_str(), static_cast<int>(t.payload.size()),
                          t.payload.data(), kAtLeastOnce, t.retain);
    if (code != MOSQ_ERR_SUCCESS) return tryAgain(mosquitto_strerror(code));
    waiting.insert(id);
  }
  Wait wait(limit);
  for (;;) {
    state_->bell.hush();
    {
      const std::lock_guard lock(state_->mutex);
      std::erase_if(waiting, [&](int id) { return state_->taken.erase(id) != 0; });
      if (waiting.empty()) return {Delivery::Result::kDelivered, "taken by the broker"};
    }
    if (wait.untilReadable(state_->bell.fd(), hurry) != Waited::kReady)
      return tryAgain("the broker took " + std::to_string(topics.size() - waiting.size()) + " of " +
                      std::to_string(topics.size()) + " messages");
  }
}

}  // namespace patina::capture::notify
