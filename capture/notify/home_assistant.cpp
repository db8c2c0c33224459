// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/home_assistant.h"

#include <nlohmann/json.hpp>

namespace patina::capture::notify {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

class Discovery {
 public:
  Discovery(const About& about, std::string base, std::string prefix)
      : base_(std::move(base)), prefix_(std::move(prefix)), node_("patina_" + about.specimen) {
    device_["identifiers"] = Json::array({node_});
    device_["name"] = "Patina " + about.specimen;
    device_["manufacturer"] = "Patina";
    device_["model"] = oneLine(about.rig);
  }

  // `topic`: below the base; `object`: unique among the entities of the device.
  void add(const std::string& component, const std::string& object, const std::string& label,
           const std::string& topic, Json more) {
    Json config = std::move(more);
    config["name"] = label;
    config["unique_id"] = node_ + "_" + object;
    config["object_id"] = node_ + "_" + object;
    config["state_topic"] = base_ + "/" + topic;
    config["availability_topic"] = base_ + "/status";
    config["device"] = device_;
    topics_.push_back(
        {prefix_ + "/" + component + "/" + node_ + "/" + object + "/config", dump(config)});
  }

  std::vector<MqttTopic> take() { return std::move(topics_); }
  std::string attributes(const std::string& topic) const { return base_ + "/" + topic; }

 private:
  std::string base_, prefix_, node_;
  Json device_;
  std::vector<MqttTopic> topics_;
};

}  // namespace

std::vector<MqttTopic> discoveryOf(const About& about, const Inventory& inventory,
                                   const std::string& base, const std::string& prefix) {
  Discovery discovery(about, base, prefix);
  discovery.add("sensor", "run", "Run", "run",
                {{"icon", "mdi:camera-timer"},
                 {"json_attributes_topic", discovery.attributes("run/attributes")}});
  for (const std::string& id : inventory.cameras)
    discovery.add("sensor", "camera_" + id, "Camera " + id, "camera/" + id,
                  {{"icon", "mdi:camera"}});
  for (const std::string& id : inventory.lights)
    discovery.add("sensor", "light_" + id, "Light " + id, "light/" + id,
                  {{"icon", "mdi:lightbulb"}});
  for (int i = 0; i < kAlertKindCount; ++i) {
    const std::string kind = name(static_cast<AlertKind>(i));
    std::string label = kind;
    for (char& c : label)
      if (c == '_') c = ' ';
    discovery.add(
        "binary_sensor", "alert_" + kind, "Alert " + label, "alert/" + kind,
        {{"device_class", "problem"},
         {"json_attributes_topic", discovery.attributes("alert/" + kind + "/attributes")}});
  }
  return discovery.take();
}

std::string attributesOf(const RunState& state, const About& about) {
  Json json;
  json["run_id"] = about.run_id;
  json["step"] = state.step;
  json["steps"] = state.steps;
  json["captured"] = state.captured;
  json["held"] = state.held;
  json["skipped"] = state.skipped;
  json["missed"] = state.missed;
  json["failed"] = state.failed;
  json["disk_free_bytes"] = state.disk_free_bytes;
  json["next_due_utc"] = formatUtc(state.next_due_utc);
  return dump(json);
}

}  // namespace patina::capture::notify
