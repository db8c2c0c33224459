// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/json_rows.h"

#include <nlohmann/json.hpp>

#include "db/columns.h"

namespace patina::daemon {
namespace {

using Json = nlohmann::ordered_json;

// A visitor of columns(): the same names as in the tables.
struct Columns {
  Json& object;

  void operator()(const char* key, UtcTime value) { object[key] = toNs(value); }
  void operator()(const char* key, MonoTime value) { object[key] = toNs(value); }
  void operator()(const char* key, Nanoseconds value) { object[key] = value.count(); }
  void operator()(const char* key, db::Decision value) { object[key] = db::name(value); }
  void operator()(const char* key, db::ShotState value) { object[key] = db::name(value); }
  void operator()(const char* key, const Sha256& value) { object[key] = value.hex(); }
  template <class T>
  void operator()(const char* key, const std::optional<T>& value) {
    object[key] = value ? Json(*value) : Json();
  }
  template <class T>
  void operator()(const char* key, const db::OrNull<T>& value) {
    object[key] = value.value == std::remove_cvref_t<T>{} ? Json() : Json(value.value);
  }
  template <class T>
  void operator()(const char* key, const T& value) {
    object[key] = value;
  }
};

template <class Row>
Json objectOf(const Row& row) {
  Json object;
  db::columns(Columns{object}, row);
  return object;
}

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json objectOf(const CameraView& camera) {
  Json object;
  object["device_id"] = camera.status.id;
  object["up"] = camera.status.up;
  object["trouble"] = camera.status.trouble;
  object["captured"] = camera.captured;
  object["failed"] = camera.failed;
  object["newest_sha256"] = camera.newest ? Json(camera.newest->sha256.hex()) : Json();
  object["newest_utc_ns"] = camera.newest ? Json(toNs(camera.newest->utc)) : Json();
  return object;
}

void addCounts(Json& object, const capture::SessionStatus& s) {
  object["step"] = s.step;
  object["steps"] = s.steps;
  object["captured"] = s.captured;
  object["held"] = s.held;
  object["skipped"] = s.skipped;
  object["missed"] = s.missed;
  object["failed"] = s.failed;
  object["partial"] = s.partial;
}

void addLive(Json& object, const RunView& view) {
  const capture::SessionStatus& s = view.status;
  object["state"] = view.state;
  object["active"] = view.active;
  object["trouble"] = view.trouble;
  object["plan"] = view.plan;
  object["devices"] = view.devices;
  object["paused"] = s.paused;
  addCounts(object, s);
  object["now_utc_ns"] = toNs(s.now_utc);
  object["next_due_utc_ns"] = toNs(s.next_due_utc);
  object["late_ns"] = s.late.count();
  object["light"] = s.light;
  object["disk_free_bytes"] = s.disk_free_bytes;
  object["note"] = s.note;
  object["cameras"] = Json::array();
  for (const CameraView& camera : view.cameras) object["cameras"].push_back(objectOf(camera));
}

// Ours is never deep; the parser's own stack grows with what a stranger nests.
Json parsed(const std::string& text) {
  constexpr int kDepthMax = 8;
  const auto shallow = [](int depth, Json::parse_event_t event, Json&) {
    if (depth > kDepthMax &&
        (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start))
      throw capture::CaptureError(Exit::kUsage, "JSON nested too deeply");
    return true;
  };
  return Json::parse(text, shallow, false);
}

template <class T>
T valueOf(const Json& object, const char* key, T fallback) {
  const auto found = object.find(key);
  if (found == object.end()) return fallback;
  if constexpr (std::same_as<T, std::string>)
    return found->is_string() ? found->template get<std::string>() : fallback;
  else if constexpr (std::same_as<T, bool>)
    return found->is_boolean() ? found->template get<bool>() : fallback;
  else  // 1e300 fits none
    return found->is_number_integer() ? found->template get<T>() : fallback;
}

CameraView cameraOf(const Json& object) {
  CameraView camera;
  camera.status.id = valueOf(object, "device_id", std::string());
  camera.status.up = valueOf(object, "up", true);
  camera.status.trouble = valueOf(object, "trouble", std::string());
  camera.captured = valueOf<std::int64_t>(object, "captured", 0);
  camera.failed = valueOf<std::int64_t>(object, "failed", 0);
  const auto utc_ns = valueOf<std::int64_t>(object, "newest_utc_ns", 0);
  if (utc_ns == 0) return camera;
  camera.newest.emplace();
  camera.newest->utc = utcFromNs(utc_ns);
  return camera;
}

RunView viewOf(const Json& object) {
  RunView view;
  capture::SessionStatus& s = view.status;
  view.id = s.run_id = valueOf(object, "id", std::string());
  view.specimen = valueOf(object, "specimen", std::string());
  view.state = valueOf(object, "state", std::string());
  view.plan = valueOf(object, "plan", std::string());
  view.active = valueOf(object, "active", false);
  view.trouble = valueOf(object, "trouble", std::string());
  s.paused = valueOf(object, "paused", false);
  for (const auto& [key, count] : {std::pair{"step", &s.step},
                                   {"steps", &s.steps},
                                   {"captured", &s.captured},
                                   {"held", &s.held},
                                   {"skipped", &s.skipped},
                                   {"missed", &s.missed},
                                   {"failed", &s.failed},
                                   {"partial", &s.partial}})
    *count = valueOf<std::int64_t>(object, key, 0);
  s.now_utc = utcFromNs(valueOf<std::int64_t>(object, "now_utc_ns", 0));
  s.next_due_utc = utcFromNs(valueOf<std::int64_t>(object, "next_due_utc_ns", 0));
  s.late = Nanoseconds(valueOf<std::int64_t>(object, "late_ns", 0));
  s.light = valueOf(object, "light", std::string());
  s.note = valueOf(object, "note", std::string());
  s.disk_free_bytes = valueOf<std::uint64_t>(object, "disk_free_bytes", 0);
  if (const auto devices = object.find("devices"); devices != object.end() && devices->is_array())
    for (const Json& device : *devices)
      if (device.is_string()) view.devices.push_back(device.get<std::string>());
  if (const auto cameras = object.find("cameras"); cameras != object.end() && cameras->is_array())
    for (const Json& camera : *cameras)
      if (camera.is_object()) view.cameras.push_back(cameraOf(camera));
  return view;
}

}  // namespace

std::string jsonOf(const db::StepRow& row) { return textOf(objectOf(row)); }
std::string jsonOf(const db::LightCheckRow& row) { return textOf(objectOf(row)); }
std::string jsonOf(const db::EventRow& row) { return textOf(objectOf(row)); }

std::string jsonOf(const db::DeviceRow& row, const std::string& held_by) {
  Json object = objectOf(row);
  object["run_id"] = held_by.empty() ? Json() : Json(held_by);
  return textOf(object);
}

std::string jsonOf(const db::ArchivePages::ShotFrame& row) {
  Json object = objectOf(db::FrameRecord{row.frame, {}});
  object.erase("run_id");
  const Json shot = objectOf(row.shot);
  for (const auto& [key, value] : shot.items())
    if (key != "id") object[key] = value;
  return textOf(object);
}

std::string jsonOf(const std::string& run_id, const std::string& camera, const db::FrameRow& row) {
  Json object = objectOf(db::FrameRecord{row, run_id});
  object["device_id"] = camera;
  return textOf(object);
}

std::string jsonOf(const RunView& view) {
  Json object;
  object["id"] = view.id;
  object["specimen"] = view.specimen;
  addLive(object, view);
  return textOf(object);
}

bool hasSpoken(const RunView* live) { return live != nullptr && live->status.steps > 0; }

std::string jsonOf(const db::RunRow& row, const RunView* live,
                   const capture::SessionStatus& counted) {
  Json object = objectOf(db::RunRecord{row, 0, 0});
  for (const char* key : {"plan_toml", "rig_toml", "specimen_id", "rig_id", "boot_id"})
    object.erase(key);
  object["specimen"] = row.specimen;
  object["rig"] = row.rig;
  if (live != nullptr) addLive(object, *live);
  if (!hasSpoken(live)) addCounts(object, counted);
  object["state"] = row.state;
  return textOf(object);
}

std::string jsonOf(const Alert& alert, bool over) {
  Json object;
  object["run_id"] = alert.run_id;
  object["what"] = alert.what;
  object["detail"] = alert.detail;
  object["since_utc_ns"] = toNs(alert.since);
  object["over"] = over;
  return textOf(object);
}

std::string jsonOf(const DaemonStatus& status) {
  Json object;
  object["version"] = status.version;
  object["archive"] = status.archive;
  object["now_utc_ns"] = toNs(status.now);
  object["started_utc_ns"] = toNs(status.started);
  object["runs_active"] = status.runs_active;
  object["alerts_active"] = status.alerts_active;
  object["disk_free_bytes"] = status.disk_free_bytes;
  return textOf(object);
}

std::string listJson(const std::string& name, const std::vector<std::string>& items,
                     std::optional<std::int64_t> next) {
  std::string text = "{\"schema\":\"patina." + name + "/1\",\"items\":[";
  for (std::size_t i = 0; i < items.size(); ++i) text += (i == 0 ? "" : ",") + items[i];
  text += "]";
  if (next) text += ",\"next\":" + std::to_string(*next);
  return text + "}\n";
}

std::optional<StartWish> startWishOf(const std::string& body) {
  const Json json = parsed(body);
  if (!json.is_object() || !json.contains("plan") || !json["plan"].is_string()) return std::nullopt;
  StartWish wish{json["plan"].get<std::string>()};
  for (const auto& [key, value] : json.items()) {
    if (key == "new_run" && value.is_boolean())
      wish.new_run = value.get<bool>();
    else if (key == "wait" && value.is_boolean())
      wish.wait = value.get<bool>();
    else if (key != "plan")
      return std::nullopt;
  }
  return wish;
}

std::string jsonOf(const StartWish& wish) {
  return textOf(Json{{"plan", wish.plan}, {"new_run", wish.new_run}, {"wait", wish.wait}});
}

std::vector<RunView> runsOf(const std::string& list) {
  const Json json = parsed(list);
  std::vector<RunView> runs;
  if (!json.is_object() || !json.contains("items") || !json["items"].is_array()) return runs;
  for (const Json& item : json["items"])
    if (item.is_object()) runs.push_back(viewOf(item));
  return runs;
}

std::optional<std::int64_t> nextOf(const std::string& list) {
  const Json json = parsed(list);
  if (!json.is_object() || !json.contains("next") || !json["next"].is_number_integer())
    return std::nullopt;
  return json["next"].get<std::int64_t>();
}

std::optional<RunView> runOf(const std::string& object) {
  const Json json = parsed(object);
  if (!json.is_object() || !json.contains("id")) return std::nullopt;
  return viewOf(json);
}

std::optional<std::pair<int, std::string>> errorOf(const std::string& answer) {
  const Json json = parsed(answer);
  if (!json.is_object() || !json.contains("error") || !json["error"].is_object())
    return std::nullopt;
  const auto exit = valueOf<std::int64_t>(json["error"], "exit", 70);
  return std::pair{exit >= 0 && exit <= 255 ? static_cast<int>(exit) : 70,
                   valueOf(json["error"], "message", std::string("no reason was given"))};
}

std::vector<std::pair<std::string, std::string>> membersOf(const std::string& text) {
  Json json = parsed(text);
  if (json.is_object() && json.contains("items") && json["items"].is_array() &&
      !json["items"].empty())
    json = Json(json["items"][0]);
  std::vector<std::pair<std::string, std::string>> members;
  if (!json.is_object()) return members;
  for (const auto& [key, value] : json.items())
    members.emplace_back(key, value.is_string() ? value.get<std::string>() : textOf(value));
  return members;
}

}  // namespace patina::daemon
