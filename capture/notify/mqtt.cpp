// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/mqtt.h"

#include "capture/notify/secret_file.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kConnectLimit = 10s, kPublishLimit = 10s, kGoodbyeLimit = 1s;

MqttTopic willOf(Mqtt::Purpose purpose, const std::string& base) {
  if (purpose == Mqtt::Purpose::kTest) return {};
  return {base + "/status", "offline", true};
}

}  // namespace

Mqtt::Mqtt(const MqttSettings& settings, About about, Inventory inventory, Purpose purpose)
    : settings_(settings),
      about_(std::move(about)),
      inventory_(std::move(inventory)),
      purpose_(purpose),
      name_("mqtt " + settings.host + ":" + std::to_string(settings.port)),
      client_(settings, settings.password_file ? readSecret(*settings.password_file) : "",
              willOf(purpose, base())) {
  set("run", "starting");
  for (const std::string& id : inventory_.cameras) set("camera/" + id, "ok");
  for (const std::string& id : inventory_.lights) set("light/" + id, "ok");
  // What an earlier process left on is off until this one says otherwise.
  for (int i = 0; i < kAlertKindCount; ++i) {
    const std::string topic =
        std::string("alert/") + patina::capture::name(static_cast<AlertKind>(i));
    set(topic, "OFF");
    set(topic + "/attributes", "{}");
  }
}

Mqtt::~Mqtt() {
  if (purpose_ == Purpose::kRun && connection_ > 0)
    client_.publish({{base() + "/status", "offline"}}, kGoodbyeLimit, {});
}

bool Mqtt::wants(const Message& message) const {
  if (purpose_ == Purpose::kTest) return message.kind == MessageKind::kTest;
  return message.kind != MessageKind::kFrame;
}

void Mqtt::set(const std::string& topic, const std::string& payload) {
  std::string& now = retained_[base() + "/" + topic];
  if (now == payload) return;
  now = payload;
  changed_.insert(base() + "/" + topic);
}

void Mqtt::takeIn(const Message& message) {
  if (message.kind == MessageKind::kStatus) {
    set("run", message.state.state);
    set("run/attributes", attributesOf(message.state, message.about));
    for (const auto& [id, state] : message.state.cameras) set("camera/" + id, state);
    for (const auto& [id, state] : message.state.lights) set("light/" + id, state);
  }
  if (message.kind == MessageKind::kAlert) {
    auto& subjects = told_[message.news.kind];
    if (message.news.event == AlertEvent::kOver)
      subjects.erase(message.news.subject);
    else
      subjects.insert(message.news.subject);
    const std::string topic = std::string("alert/") + patina::capture::name(message.news.kind);
    set(topic, subjects.empty() ? "OFF" : "ON");
    set(topic + "/attributes", jsonOf(message));
  }
}

Delivery Mqtt::send(const Message& message, const std::stop_token& hurry) {
  takeIn(message);
  if (Delivery up = client_.connect(kConnectLimit, hurry); !up.delivered()) return up;
  std::vector<MqttTopic> topics;
  const int connection = client_.connection();
  if (purpose_ == Purpose::kRun) {
    if (connection != connection_) {
      if (!settings_.discovery.empty())
        topics = discoveryOf(about_, inventory_, base(), settings_.discovery);
      for (const auto& [topic, payload] : retained_) topics.push_back({topic, payload});
      topics.push_back({base() + "/status", "online"});
    } else {
      for (const std::string& topic : changed_) topics.push_back({topic, retained_[topic]});
    }
  }
  if (message.kind != MessageKind::kStatus)
    topics.push_back({base() + (message.kind == MessageKind::kTest ? "/test" : "/event"),
                      jsonOf(message), false});
  Delivery delivery = client_.publish(topics, kPublishLimit, hurry);
  if (delivery.delivered()) {
    connection_ = connection;
    changed_.clear();
  }
  return delivery;
}

}  // namespace patina::capture::notify
