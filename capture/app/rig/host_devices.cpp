// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/host_devices.h"

#include <algorithm>
#include <map>

#include "devices/host/hosted_devices.h"

namespace patina::rig {
namespace {

using devices::RigSpec;
using devices::host::DriverLink;

constexpr std::uint64_t kMemoryMaxBytes = 8ull << 30;  // of addresses: a decoder that goes mad

// Which devices go into which process, by a key, and the links to them.
class Processes {
 public:
  Processes(const RigSpec& spec, const World& world, devices::Clock& clock,
            const std::vector<std::string>& command)
      : spec_(spec), world_(world), clock_(clock), command_(command) {}

  void add(const std::string& key, const std::string& device, const std::string& on) {
    Group& group = groups_[key];
    group.on = on;
    place_[device] = {key, static_cast<std::uint16_t>(group.devices.size())};
    group.devices.push_back(device);
  }
  bool has(const std::string& device) const { return place_.contains(device); }
  std::uint16_t placeOf(const std::string& device) const { return place_.at(device).second; }

  std::shared_ptr<DriverLink> linkOf(const std::string& device) {
    Group& group = groups_.at(place_.at(device).first);
    if (!group.link) group.link = std::make_shared<DriverLink>(optionsOf(group), clock_);
    return group.link;
  }

 private:
  struct Group {
    std::string on;
    std::vector<std::string> devices;
    std::shared_ptr<DriverLink> link;
  };

  devices::host::LinkOptions optionsOf(const Group& group) const {
    devices::host::LinkOptions options;
    options.name = "driver of '" + group.devices.front() + "'";
    if (group.devices.size() > 1)
      options.name += " and " + std::to_string(group.devices.size() - 1) + " more";
    options.hello.rig_toml = spec_.toml;
    options.hello.rig_file = spec_.source.string();
    options.hello.devices = group.devices;
    options.hello.told_time = !clock_.threadSafe();
    options.hello.seed = world_.seed;
    options.hello.duration = world_.duration;
    options.hello.start_utc = world_.start_utc;
    options.hello.memory_max_bytes = kMemoryMaxBytes;
    if (!command_.empty()) options.command = command_;
    // A process that takes long for a call takes long to begin.
    for (const devices::CameraSpec& camera : spec_.cameras)
      if (camera.id == group.devices.front())
        options.start_limit = std::max(options.start_limit, camera.call_limit);
    for (const devices::HostSpec& host : spec_.hosts)
      if (host.id == group.on) options.remote = {host.address, host.key};
    return options;
  }

  const RigSpec& spec_;
  const World& world_;
  devices::Clock& clock_;
  const std::vector<std::string>& command_;
  std::map<std::string, Group> groups_;
  std::map<std::string, std::pair<std::string, std::uint16_t>> place_;
};

// What hangs on one port, board or line shares a process: a second could not open it.
std::string placeOf(const devices::LightSpec& light) {
  const Backend* backend = backendNamed(light.backend);
  return backend && backend->shared_line ? backend->shared_line(light) : light.address;
}
std::string placeOf(const devices::TriggerSpec& trigger) { return trigger.address; }
std::string placeOf(const devices::SensorSpec& sensor) {
  const auto port = sensor.settings.find("port");
  return port == sensor.settings.end() ? sensor.id : port->second;
}
std::string placeOf(const devices::CameraSpec& camera) { return camera.id; }

void distribute(const RigSpec& spec, Processes& processes) {
  const bool twin_hosted = spec.twin && spec.twin->hosted;
  const auto add_all = [&](const auto& all) {
    for (const auto& d : all) {
      if (d.backend != kTwinBackend)
        processes.add(d.backend + "\n" + placeOf(d) + "\n" + d.on, d.id, d.on);
      else if (twin_hosted)
        processes.add(kTwinBackend, d.id, d.on);
    }
  };
  add_all(spec.cameras);
  add_all(spec.lights);
  add_all(spec.sensors);
  add_all(spec.triggers);
}

devices::host::CameraLimits limitsOf(const RigSpec& spec, const std::string& id, bool shared) {
  devices::host::CameraLimits limits;
  for (const devices::CameraSpec& camera : spec.cameras)
    if (camera.id == id) limits.call = camera.call_limit;
  if (shared) limits.recycle_shots = std::numeric_limits<int>::max();
  return limits;
}

}  // namespace

devices::Rig makeHosted(const devices::host::Hello& hello, devices::Clock& clock) {
  World world;
  world.seed = hello.seed;
  world.duration = hello.duration;
  world.start_utc = hello.start_utc;
  const RigSpec whole = devices::parseRig(hello.rig_toml, hello.rig_file);
  if (whole.twin && whole.twin->faults) world.faults = devices::readFaults(*whole.twin->faults);
  return makeDevices(onlyThese(whole, hello.devices), world, clock);
}

// Made here first: devices know their capabilities before they are opened. Those that belong into
// another process are replaced by its like.
devices::Rig openHosted(const RigSpec& spec, const World& world, devices::Clock& clock,
                        const std::vector<std::string>& command) {
  devices::Rig rig = makeDevices(spec, world, clock);
  Processes processes(spec, world, clock, command);
  distribute(spec, processes);
  const bool twin_hosted = spec.twin && spec.twin->hosted;
  for (auto& camera : rig.cameras) {
    const std::string id = camera->caps().id;
    if (processes.has(id))
      camera = devices::host::makeHostedCamera(camera->caps(), processes.linkOf(id),
                                               processes.placeOf(id),
                                               limitsOf(spec, id, twin_hosted), clock);
  }
  for (auto& light : rig.lights) {
    const std::string id = light->caps().id;
    if (processes.has(id))
      light = devices::host::makeHostedLight(light->caps(), processes.linkOf(id),
                                             processes.placeOf(id));
  }
  for (auto& sensor : rig.sensors) {
    const std::string id = sensor->caps().id;
    if (processes.has(id))
      sensor = devices::host::makeHostedSensor(sensor->caps(), processes.linkOf(id),
                                               processes.placeOf(id));
  }
  for (auto& trigger : rig.triggers) {
    const std::string id = trigger->id();
    if (processes.has(id))
      trigger = devices::host::makeHostedTrigger(id, processes.linkOf(id), processes.placeOf(id));
  }
  return rig;
}

}  // namespace patina::rig
