// SPDX-License-Identifier: GPL-3.0-or-later
// What Home Assistant must be told so that it shows a rig by itself: MQTT discovery.
// https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery
#pragma once

#include <string>
#include <vector>

#include "capture/notify/message.h"
#include "capture/notify/mqtt_client.h"

namespace patina::capture::notify {

// The devices of a rig, by id.
struct Inventory {
  std::vector<std::string> cameras, lights;
};

// One retained config topic an entity: the run, each camera and light, each condition; all of one
// device, unavailable unless `base`/status is "online". Topics and values: README.md.
std::vector<MqttTopic> discoveryOf(const About& about, const Inventory& inventory,
                                   const std::string& base, const std::string& prefix);

// The counts of a run as the attributes of its entity.
std::string attributesOf(const RunState& state, const About& about);

}  // namespace patina::capture::notify
