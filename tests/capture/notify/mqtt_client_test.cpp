// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/mqtt_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/notify/broker.h"
#include "tests/capture/notify/receiver.h"
#include "tests/support/child.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using patina::testing::Broker;
using patina::testing::Listener;
using ::testing::HasSubstr;
using Result = Delivery::Result;

TEST(MqttClient, IsAnsweredWhenTheBrokerHasEverything) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  MqttClient client(broker.settings(), "", {});
  ASSERT_TRUE(client.connect(10s, {}).delivered());
  const Delivery delivery = client.publish({{"a/b", "1"}, {"a/c", "2"}}, 10s, {});
  EXPECT_TRUE(delivery.delivered()) << delivery.answer;
  listener.waitFor("a/b", "1");
  listener.waitFor("a/c", "2");
}

TEST(MqttClient, ComesBackAfterTheBrokerDid) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  MqttClient client(broker.settings(), "", {});
  ASSERT_TRUE(client.connect(10s, {}).delivered());
  const int before = client.connection();
  broker.stop();
  EXPECT_EQ(client.publish({{"a", "1"}}, 200ms, {}).result, Result::kTryAgain);
  broker.start();
  while (!client.connect(2s, {}).delivered()) continue;
  EXPECT_GT(client.connection(), before);
  EXPECT_TRUE(client.publish({{"a", "2"}}, 10s, {}).delivered());
}

TEST(MqttClient, SaysWhyABrokerTurnsItAway) {
  PATINA_BROKER_OR_SKIP();
  const auto folder = patina::testing::TempFolder::inMemory();
  const std::string file = (folder / "passwords").string();
  ASSERT_EQ(
      patina::testing::run({"/usr/bin/mosquitto_passwd", "-c", "-b", file, "rig", "hunter2"}).exit,
      0);
  Broker broker("allow_anonymous false\npassword_file " + file);
  MqttSettings settings = broker.settings();
  settings.user = "rig";
  MqttClient wrong(settings, "hunter3", {});
  const Delivery delivery = wrong.connect(10s, {});
  EXPECT_EQ(delivery.result, Result::kTryAgain);
  EXPECT_THAT(delivery.answer, HasSubstr("not authorised"));
  EXPECT_THAT(delivery.answer, ::testing::Not(HasSubstr("hunter")));
  MqttClient right(settings, "hunter2", {});
  EXPECT_TRUE(right.connect(10s, {}).delivered());
}

TEST(MqttClient, GivesUpOnNobodyOnAHangingOneAndWhenTheProgramEnds) {
  MqttSettings settings;
  settings.host = "127.0.0.1";
  settings.port = patina::testing::freePort();
  MqttClient nobody(settings, "", {});
  EXPECT_EQ(nobody.connect(100ms, {}).result, Result::kTryAgain);
  patina::testing::Receiver silent("");
  settings.port = silent.port();
  MqttClient hanging(settings, "", {});
  EXPECT_EQ(hanging.connect(100ms, {}).result, Result::kTryAgain);
  std::stop_source hurry;
  hurry.request_stop();
  EXPECT_EQ(hanging.connect(1h, hurry.get_token()).result, Result::kTryAgain);
  EXPECT_EQ(hanging.publish({{"a", "1"}}, 1h, {}).result, Result::kTryAgain);
}

}  // namespace
}  // namespace patina::capture::notify
