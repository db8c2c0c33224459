// SPDX-License-Identifier: GPL-3.0-or-later
// A rig: what is bolted together. RigSpec is the file, Rig the living devices.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/light.h"
#include "devices/sensor.h"
#include "devices/trigger.h"

namespace patina::devices {

enum class Between { kOff, kOn, kKeep };  // what a lamp does between shots; keep: as a sweep ends

struct CameraSpec {
  std::string id, backend, serial;
  std::string on;  // the [[host]] whose machine it hangs on; empty: this one
  Nanoseconds call_limit = std::chrono::seconds(10);  // of a call that has no deadline of its own
  std::string power;  // what a power cycle switches: "hub", or the id of a [[power]]
  std::map<std::string, std::string> settings;  // backend's own, checked by the backend
};
struct LightSpec {
  std::string id, backend, address;
  std::string on;
  std::array<double, 3> position_mm{0, 0, 500};
  Between between = Between::kOff;
  std::map<std::string, std::string> settings;
};
struct SensorSpec {
  std::string id, backend, on;
  Quantity quantity = Quantity::kIlluminance;
  std::optional<std::array<double, 2>> band;  // relative for illuminance ([0.97,1.03] of its
                                              // baseline), absolute in unit() otherwise
  std::map<std::string, std::string> settings;
};
struct TriggerSpec {
  std::string id, backend, address;
  std::string on;
  std::vector<std::string> cameras;  // whose shutters hang on this line
  std::map<std::string, std::string> settings;
};
struct HostSpec {  // another machine, where `patina device-host --listen` runs
  std::string id;
  std::string address;        // "pi.local:8461"
  std::filesystem::path key;  // the shared key's file, relative to the rig file
};
struct PatchSpec {  // the grey reference patch in a camera's picture
  std::string camera;
  RectPx rect_px;
};
// Something of known shape and reflectance that lies in a twin's scene.
struct TargetSpec {
  enum Kind { kGreyCard, kColorChecker, kChessboard, kCharuco, kMirrorSphere };
  Kind kind = kGreyCard;
  std::array<double, 3> position_mm{};   // its middle
  std::array<double, 3> rotation_deg{};  // about x, then y, then z of the rig; 0: faces up
  double width_mm = 20;                  // along its own x; a sphere's diameter
  int columns = 10, rows = 7;            // squares of a board
  double reflectance = 0.36;             // of a grey card; of a sphere at normal incidence
};
enum class Surroundings { kDark, kRoom, kDaylight };  // light that is not the rig's
struct TwinSpec {
  std::string specimen = "banana_ripening";
  SizePx size{512, 512};
  bool hosted = false;                          // the whole world in a process of its own
  std::optional<std::filesystem::path> faults;  // relative to the rig file
  bool shadows = false;                         // cast by the specimen's relief
  Surroundings surroundings = Surroundings::kDark;
  std::vector<TargetSpec> targets;
};
struct RigSpec {
  std::string name;
  std::vector<CameraSpec> cameras;
  std::vector<LightSpec> lights;
  std::vector<SensorSpec> sensors;
  std::vector<TriggerSpec> triggers;
  std::vector<LightSpec> powers;  // [[power]]: relays that are no lamps, of a light's backend
  std::vector<HostSpec> hosts;
  std::vector<PatchSpec> patches;  // at most one a camera
  std::optional<TwinSpec> twin;
  std::string toml;  // the text it was read from
  std::filesystem::path source;
};

// Throws ConfigError (config_file.h) naming file, line, key and allowed range. Ids are unique over
// all devices: 1 to 32 of a-z 0-9 _ -. Backends are names only: who makes the devices knows them.
RigSpec readRig(const std::filesystem::path& file);
RigSpec parseRig(const std::string& toml, const std::filesystem::path& source);

struct Rig {
  RigSpec spec;
  std::vector<std::unique_ptr<Camera>> cameras;
  std::vector<std::unique_ptr<Light>> lights;
  std::vector<std::unique_ptr<Sensor>> sensors;
  std::vector<std::unique_ptr<Trigger>> triggers;
};

// "key+lamp" of {lamp, key}: sorted ids joined by '+'; "off" when empty.
std::string lightStateName(std::vector<std::string> lights);
std::vector<std::string> lightsOfState(const std::string& name);

}  // namespace patina::devices
