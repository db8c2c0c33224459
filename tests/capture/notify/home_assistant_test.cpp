// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/home_assistant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/capture/notify/messages.h"

namespace patina::capture::notify {
namespace {

std::map<std::string, nlohmann::json> discover() {
  std::map<std::string, nlohmann::json> found;
  for (const MqttTopic& t : discoveryOf(cameraDown().about, {{"cam0", "cam1"}, {"key"}},
                                        "patina/banana", "homeassistant")) {
    EXPECT_TRUE(t.retain);
    found[t.topic] = nlohmann::json::parse(t.payload);
  }
  return found;
}

TEST(HomeAssistant, FindsTheRunEveryCameraLightAndCondition) {
  const auto found = discover();
  EXPECT_EQ(found.size(), 1u + 2 + 1 + kAlertKindCount);
  const auto& camera = found.at("homeassistant/sensor/patina_banana/camera_cam1/config");
  EXPECT_EQ(camera["state_topic"], "patina/banana/camera/cam1");
  EXPECT_EQ(camera["availability_topic"], "patina/banana/status");
  const auto& alert =
      found.at("homeassistant/binary_sensor/patina_banana/alert_camera_down/config");
  EXPECT_EQ(alert["device_class"], "problem");
  EXPECT_EQ(alert["state_topic"], "patina/banana/alert/camera_down");
  EXPECT_EQ(alert["json_attributes_topic"], "patina/banana/alert/camera_down/attributes");
  EXPECT_EQ(found.at("homeassistant/sensor/patina_banana/light_key/config")["state_topic"],
            "patina/banana/light/key");
}

TEST(HomeAssistant, ShowsThemAsOneDeviceWithUniqueIds) {
  std::set<std::string> ids;
  for (const auto& [topic, config] : discover()) {
    ids.insert(config["unique_id"].get<std::string>());
    EXPECT_EQ(config["device"]["identifiers"][0], "patina_banana");
    EXPECT_EQ(config["device"]["model"], "banana box");
  }
  EXPECT_EQ(ids.size(), discover().size());
}

TEST(HomeAssistant, GetsTheCountsOfTheRunAsAttributes) {
  const auto json = nlohmann::json::parse(attributesOf(status(7).state, status(7).about));
  EXPECT_EQ(json["step"], 7);
  EXPECT_EQ(json["run_id"], "20240501T120000Z-banana");
}

}  // namespace
}  // namespace patina::capture::notify
