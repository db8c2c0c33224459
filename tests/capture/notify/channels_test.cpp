// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/notify/messages.h"

namespace patina::capture::notify {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Channels, AreThoseOfThePlan) {
  AlertSettings settings;
  settings.webhooks = {{"https://a.example/x", {}, {}}, {"https://b.example/y", {}, {}}};
  settings.email = EmailSettings{{"lab@example.org"}, ""};
  settings.mqtt = MqttSettings{};
  settings.heartbeat = HeartbeatSettings{"https://hc.example/z", {}};
  const Channels channels = openChannels(settings, cameraDown().about, {}, Mqtt::Purpose::kRun);
  std::vector<std::string> names;
  for (const auto& channel : channels.open) names.push_back(channel->name());
  EXPECT_THAT(names, ElementsAre("heartbeat hc.example", "webhook a.example", "webhook b.example",
                                 "email lab@example.org", "mqtt localhost:1883"));
  EXPECT_TRUE(channels.problems.empty());
}

TEST(Channels, OpenWithoutTheOneWhoseSecretIsGone) {
  AlertSettings settings;
  settings.webhooks = {{"", "/nowhere/url", {}}, {"https://b.example/y", {}, {}}};
  const Channels channels = openChannels(settings, cameraDown().about, {}, Mqtt::Purpose::kRun);
  EXPECT_EQ(channels.open.size(), 1u);
  EXPECT_THAT(channels.problems, ElementsAre(HasSubstr("webhook: the secret /nowhere/url")));
}

}  // namespace
}  // namespace patina::capture::notify
