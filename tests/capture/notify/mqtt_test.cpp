// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/mqtt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/notify/broker.h"
#include "tests/capture/notify/messages.h"

namespace patina::capture::notify {
namespace {

using patina::testing::Broker;
using patina::testing::Listener;
using ::testing::HasSubstr;

std::unique_ptr<Mqtt> mqttOf(const MqttSettings& settings,
                             Mqtt::Purpose purpose = Mqtt::Purpose::kRun) {
  return std::make_unique<Mqtt>(settings, cameraDown().about, Inventory{{"cam0"}, {"key"}},
                                purpose);
}

TEST(Mqtt, LeavesTheStateOfTheRigForWhoeverComesLater) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  const auto mqtt = mqttOf(broker.settings());
  ASSERT_TRUE(mqtt->send(status(7), {}).delivered());
  ASSERT_TRUE(mqtt->send(cameraDown(), {}).delivered());
  Listener late(broker.settings());
  late.waitFor("patina/banana/status", "online");
  late.waitFor("patina/banana/run", "running");
  late.waitFor("patina/banana/camera/cam0", "ok");
  late.waitFor("patina/banana/light/key", "ok");
  late.waitFor("patina/banana/alert/camera_down", "ON");
  late.waitFor("patina/banana/alert/lamp_dead", "OFF");
  EXPECT_THAT(late.waitForAny("homeassistant/sensor/patina_banana/camera_cam0/config"),
              HasSubstr("patina/banana/camera/cam0"));
  EXPECT_EQ(late.newest().count("patina/banana/event"), 0u);
}

TEST(Mqtt, TurnsAConditionOffWhenItsLastSubjectIsWell) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  const auto mqtt = mqttOf(broker.settings());
  Message other = cameraDown();
  other.news.subject = "cam1";
  ASSERT_TRUE(mqtt->send(cameraDown(), {}).delivered());
  ASSERT_TRUE(mqtt->send(other, {}).delivered());
  ASSERT_TRUE(mqtt->send(over(), {}).delivered());
  listener.waitFor("patina/banana/event", jsonOf(over()));
  EXPECT_EQ(listener.newest()["patina/banana/alert/camera_down"], "ON");
  other.news.event = AlertEvent::kOver;
  ASSERT_TRUE(mqtt->send(other, {}).delivered());
  listener.waitFor("patina/banana/alert/camera_down", "OFF");
}

TEST(Mqtt, SaysGoodbyeWhenItIsClosed) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  auto mqtt = mqttOf(broker.settings());
  ASSERT_TRUE(mqtt->send(status(1), {}).delivered());
  listener.waitFor("patina/banana/status", "online");
  mqtt.reset();
  listener.waitFor("patina/banana/status", "offline");
}

TEST(Mqtt, SaysEverythingAgainToABrokerThatForgotIt) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  const auto mqtt = mqttOf(broker.settings());
  ASSERT_TRUE(mqtt->send(cameraDown(), {}).delivered());
  broker.stop();
  broker.start();
  while (!mqtt->send(status(8), {}).delivered()) continue;
  Listener late(broker.settings());
  late.waitFor("patina/banana/alert/camera_down", "ON");
  late.waitFor("patina/banana/status", "online");
  late.waitForAny("homeassistant/sensor/patina_banana/run/config");
}

TEST(Mqtt, LeavesNothingBehindOfATest) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  {
    const auto mqtt = mqttOf(broker.settings(), Mqtt::Purpose::kTest);
    EXPECT_FALSE(mqtt->wants(cameraDown()));
    ASSERT_TRUE(mqtt->send(test(), {}).delivered());
    listener.waitFor("patina/banana/test", jsonOf(test()));
  }
  EXPECT_EQ(listener.newest().size(), 1u);
  const Listener late(broker.settings());
  EXPECT_EQ(late.retained(), 0);
}

TEST(Mqtt, SpeaksToHomeAssistantOnlyWhereItIsWanted) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  MqttSettings settings = broker.settings();
  settings.discovery = "";
  settings.topic = "lab";
  const auto mqtt = mqttOf(settings);
  ASSERT_TRUE(mqtt->send(status(1), {}).delivered());
  listener.waitFor("lab/banana/status", "online");
  for (const auto& [topic, payload] : listener.newest())
    EXPECT_EQ(topic.substr(0, 11), "lab/banana/") << topic;
}

TEST(Mqtt, WantsAllButFrames) {
  const auto mqtt = mqttOf({});
  EXPECT_TRUE(mqtt->wants(cameraDown()));
  EXPECT_TRUE(mqtt->wants(status(1)));
  EXPECT_TRUE(mqtt->wants(run("x")));
  EXPECT_FALSE(mqtt->wants(frame()));
}

}  // namespace
}  // namespace patina::capture::notify
