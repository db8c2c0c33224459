// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/rig.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "devices/config_rect.h"
#include "devices/fault_plan.h"

namespace patina::devices {
namespace {

constexpr int kTwinSideMaxPx = 16'384;  // what one simulated frame may cost in memory
constexpr int kPatchSideMinPx = 4;      // fewer texels measure their own noise
constexpr double kPositionMaxMm = 1e6;
constexpr int kCharucoMarkers = 50;
constexpr Nanoseconds kCallLimitMin = std::chrono::milliseconds(50);
constexpr Nanoseconds kCallLimitMax = std::chrono::minutes(10);

class Ids {
 public:
  std::string take(ConfigTable& table) {
    std::string id = table.takeId("id");
    if (id == kWholeRig || id == kTheSpecimen)
      table.reject("id", '"' + id + "\" has a meaning of its own in a faults file");
    if (!seen_.insert(id).second) table.reject("id", '"' + id + "\" names two devices");
    return id;
  }

 private:
  std::set<std::string> seen_;
};

std::map<std::string, std::string> takeSettings(ConfigTable& table) {
  std::map<std::string, std::string> settings;
  if (auto inner = table.takeTable("settings")) {
    for (auto& [key, value] : inner->takeRest()) settings.emplace(key, value);
  }
  return settings;
}

CameraSpec takeCamera(ConfigTable& table, Ids& ids) {
  CameraSpec camera;
  camera.id = ids.take(table);
  camera.backend = table.takeId("backend");
  camera.serial = table.takeString("serial", "");
  camera.on = table.takeString("on", "");
  camera.call_limit =
      table.takeDuration("call_limit", kCallLimitMin, kCallLimitMax, camera.call_limit);
  camera.power = table.takeString("power", "");
  camera.settings = takeSettings(table);
  table.finish();
  return camera;
}

LightSpec takeLight(ConfigTable& table, Ids& ids) {
  LightSpec light;
  light.id = ids.take(table);
  if (light.id == "off") table.reject("id", "\"off\" is the name of the dark state");
  light.backend = table.takeId("backend");
  light.address = table.takeString("address", "");
  light.on = table.takeString("on", "");
  const auto position = table.takeNumbers("position_mm", 3, std::vector<double>{0, 0, 500});
  std::copy(position.begin(), position.end(), light.position_mm.begin());
  for (const double mm : position) {
    if (std::abs(mm) > kPositionMaxMm) {
      table.reject("position_mm", "is out of range (-1000000 to 1000000 mm)");
    }
  }
  const std::string between = table.takeChoice("between", {"on", "off", "keep"}, "off");
  light.between = between == "on"    ? Between::kOn
                  : between == "off" ? Between::kOff
                                     : Between::kKeep;
  light.settings = takeSettings(table);
  table.finish();
  return light;
}

LightSpec takePower(ConfigTable& table, Ids& ids) {
  LightSpec power;
  power.id = ids.take(table);
  power.backend = table.takeId("backend");
  power.address = table.takeString("address", "");
  power.settings = takeSettings(table);
  table.finish();
  return power;
}

SensorSpec takeSensor(ConfigTable& table, Ids& ids) {
  SensorSpec sensor;
  sensor.id = ids.take(table);
  sensor.backend = table.takeId("backend");
  sensor.on = table.takeString("on", "");
  std::vector<std::string> names;
  for (const Quantity q : {Quantity::kIlluminance, Quantity::kTemperature, Quantity::kHumidity}) {
    names.push_back(name(q));
  }
  const std::string quantity = table.takeChoice("quantity", names);
  const auto at = std::find(names.begin(), names.end(), quantity) - names.begin();
  sensor.quantity = static_cast<Quantity>(at);
  if (table.has("band")) {
    const auto band = table.takeNumbers("band", 2);
    const bool relative = sensor.quantity == Quantity::kIlluminance;
    if (!(band[0] < band[1])) table.reject("band", "must be [low, high] with low below high");
    if (relative && !(band[0] >= 0 && band[0] <= 1 && band[1] >= 1)) {
      table.reject("band", "must hold 1, the baseline itself, as [0.97, 1.03]");
    }
    sensor.band = {band[0], band[1]};
  }
  sensor.settings = takeSettings(table);
  table.finish();
  return sensor;
}

TriggerSpec takeTrigger(ConfigTable& table, Ids& ids) {
  TriggerSpec trigger;
  trigger.id = ids.take(table);
  trigger.backend = table.takeId("backend");
  trigger.address = table.takeString("address", "");
  trigger.on = table.takeString("on", "");
  if (table.has("cameras")) trigger.cameras = table.takeStrings("cameras");
  trigger.settings = takeSettings(table);
  table.finish();
  return trigger;
}

std::array<double, 3> takePoint(ConfigTable& table, const std::string& key, double most,
                                std::vector<double> fallback) {
  const auto numbers = table.takeNumbers(key, 3, std::move(fallback));
  std::array<double, 3> point{};
  std::copy(numbers.begin(), numbers.end(), point.begin());
  for (const double n : point)
    if (std::abs(n) > most) table.reject(key, "is out of range");
  return point;
}

TargetSpec takeTarget(ConfigTable& table) {
  TargetSpec target;
  const std::vector<std::string> kinds{"grey_card", "colorchecker", "chessboard", "charuco",
                                       "mirror_sphere"};
  const std::string kind = table.takeChoice("kind", kinds);
  target.kind =
      static_cast<TargetSpec::Kind>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
  target.position_mm = takePoint(table, "position_mm", kPositionMaxMm, {0, 0, 0});
  target.width_mm = table.takeNumber("width_mm", 0.1, 1e4, target.width_mm);
  if (target.kind != TargetSpec::kMirrorSphere)
    target.rotation_deg = takePoint(table, "rotation_deg", 180, {0, 0, 0});
  if (target.kind == TargetSpec::kChessboard || target.kind == TargetSpec::kCharuco) {
    target.columns = static_cast<int>(table.takeInteger("columns", 3, 40, target.columns));
    target.rows = static_cast<int>(table.takeInteger("rows", 3, 40, target.rows));
  }
  if (target.kind == TargetSpec::kCharuco && target.columns * target.rows / 2 > kCharucoMarkers)
    table.reject("columns", "and rows make more than " + std::to_string(kCharucoMarkers) +
                                " markers (the dictionary 4x4_50)");
  if (target.kind == TargetSpec::kGreyCard || target.kind == TargetSpec::kMirrorSphere)
    target.reflectance = table.takeNumber(
        "reflectance", 0, 1, target.kind == TargetSpec::kGreyCard ? target.reflectance : 0.9);
  table.finish();
  return target;
}

TwinSpec takeTwin(ConfigTable& table) {
  TwinSpec twin;
  twin.specimen = table.takeString("specimen", twin.specimen);
  twin.size = table.takeSize("size", 16, kTwinSideMaxPx, twin.size);
  if (table.has("faults")) twin.faults = table.takePath("faults");
  twin.hosted = table.takeBool("hosted", false);
  twin.shadows = table.takeBool("shadows", false);
  const std::vector<std::string> surroundings{"dark", "room", "daylight"};
  const std::string chosen = table.takeChoice("surroundings", surroundings, surroundings.front());
  twin.surroundings = static_cast<Surroundings>(
      std::find(surroundings.begin(), surroundings.end(), chosen) - surroundings.begin());
  for (ConfigTable& t : table.takeTables("target")) twin.targets.push_back(takeTarget(t));
  table.finish();
  return twin;
}

HostSpec takeHost(ConfigTable& table, Ids& ids) {
  HostSpec host;
  host.id = ids.take(table);
  host.address = table.takeString("address");
  const std::size_t colon = host.address.rfind(':');
  const std::string port = colon == std::string::npos ? "" : host.address.substr(colon + 1);
  if (colon == 0 || port.empty() || port.size() > 5 ||
      port.find_first_not_of("0123456789") != std::string::npos)
    table.reject("address", "must be NAME:PORT, as in \"pi.local:8461\"");
  host.key = table.takePath("key");
  table.finish();
  return host;
}

// What names a host or a power switch must find it in this file.
void checkNames(const ConfigTable& table, const RigSpec& rig) {
  const auto require_host = [&](const std::string& device, const std::string& on) {
    const auto named = [&](const HostSpec& host) { return host.id == on; };
    if (!on.empty() && std::none_of(rig.hosts.begin(), rig.hosts.end(), named))
      table.reject(device, "hangs on \"" + on + "\", which is no [[host]] of this rig");
  };
  for (const auto& d : rig.cameras) require_host(d.id, d.on);
  for (const auto& d : rig.lights) require_host(d.id, d.on);
  for (const auto& d : rig.sensors) require_host(d.id, d.on);
  for (const auto& d : rig.triggers) require_host(d.id, d.on);
  const auto known = [](const auto& devices, const std::string& id) {
    return std::any_of(devices.begin(), devices.end(), [&](const auto& d) { return d.id == id; });
  };
  for (const CameraSpec& camera : rig.cameras)
    if (!camera.power.empty() && camera.power != "hub" && !known(rig.powers, camera.power))
      table.reject(camera.id,
                   "is powered by \"" + camera.power + "\": neither \"hub\" nor a [[power]]");
  for (const TriggerSpec& trigger : rig.triggers)
    for (const std::string& camera : trigger.cameras)
      if (!known(rig.cameras, camera))
        table.reject(trigger.id, "fires \"" + camera + "\", which is no [[camera]] of this rig");
}

RectPx takePatchRect(ConfigTable& table, const std::string& key) {
  const RectPx rect = takeRect(table, key);
  if (std::min(rect.width, rect.height) < kPatchSideMinPx)
    table.reject(key, "is too small to measure light on (4 px a side at least)");
  return rect;
}

PatchSpec takePatch(ConfigTable& table, const RigSpec& rig) {
  PatchSpec patch;
  const bool lone = rig.cameras.size() == 1;
  patch.camera =
      lone ? table.takeString("camera", rig.cameras.front().id) : table.takeString("camera");
  const auto camera = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                   [&](const CameraSpec& c) { return c.id == patch.camera; });
  if (camera == rig.cameras.end()) table.reject("camera", "names no camera of this rig");
  for (const PatchSpec& other : rig.patches) {
    if (other.camera == patch.camera) table.reject("camera", "has two patches");
  }
  patch.rect_px = takePatchRect(table, "rect_px");
  const RectPx& r = patch.rect_px;
  const bool own_size = camera->settings.count("width") || camera->settings.count("height");
  const bool twin_sized = rig.twin && camera->backend == "twin" && !own_size;
  const SizePx size = twin_sized ? rig.twin->size : SizePx{kSideMaxPx, kSideMaxPx};
  if (r.x + r.width > size.width || r.y + r.height > size.height) {
    table.reject("rect_px", "reaches beyond the picture (" + std::to_string(size.width) + "x" +
                                std::to_string(size.height) + ")");
  }
  table.finish();
  return patch;
}

}  // namespace

RigSpec readRig(const std::filesystem::path& file) {
  return parseRig(ConfigFile::readText(file), file);
}

RigSpec parseRig(const std::string& toml, const std::filesystem::path& source) {
  ConfigTable table = ConfigFile::parse(toml, source);
  RigSpec rig;
  Ids ids;
  rig.toml = toml;
  rig.source = source;
  rig.name = table.takeString("name", source.stem().string());
  for (ConfigTable& t : table.takeTables("camera")) rig.cameras.push_back(takeCamera(t, ids));
  for (ConfigTable& t : table.takeTables("light")) rig.lights.push_back(takeLight(t, ids));
  for (ConfigTable& t : table.takeTables("sensor")) rig.sensors.push_back(takeSensor(t, ids));
  for (ConfigTable& t : table.takeTables("trigger")) rig.triggers.push_back(takeTrigger(t, ids));
  for (ConfigTable& t : table.takeTables("power")) rig.powers.push_back(takePower(t, ids));
  for (ConfigTable& t : table.takeTables("host")) rig.hosts.push_back(takeHost(t, ids));
  if (auto twin = table.takeTable("twin")) rig.twin = takeTwin(*twin);
  for (ConfigTable& t : table.takeTables("patch")) rig.patches.push_back(takePatch(t, rig));
  table.finish();
  checkNames(table, rig);
  if (rig.cameras.empty()) table.reject("camera", "is missing; a rig has at least one [[camera]]");
  return rig;
}

std::string lightStateName(std::vector<std::string> lights) {
  std::sort(lights.begin(), lights.end());
  lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
  std::string state;
  for (const std::string& light : lights) state += (state.empty() ? "" : "+") + light;
  return state.empty() ? "off" : state;
}

std::vector<std::string> lightsOfState(const std::string& name) {
  std::vector<std::string> lights;
  if (name == "off") return lights;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find('+', from), name.size());
    if (to > from) lights.push_back(name.substr(from, to - from));
    from = to + 1;
  }
  return lights;
}

}  // namespace patina::devices
