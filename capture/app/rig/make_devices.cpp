// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/make_devices.h"

#include <algorithm>

#include "capture/app/rig/camera_rungs.h"
#include "capture/failure.h"
#include "devices/twin/twin.h"

namespace patina::rig {
namespace {

using devices::RigSpec;

[[noreturn]] void refuse(const std::string& device, const std::string& backend,
                         const std::string& kind) {
  std::string names = kTwinBackend;
  for (const Backend& b : backends()) names += ", " + b.name;
  throw capture::CaptureError(
      Exit::kUnavailable,
      kind + " '" + device + "' asks for the backend '" + backend + "'; there are: " + names);
}

// `member` picks the maker of the kind.
template <class Device, class Spec, class Member>
std::unique_ptr<Device> make(const Spec& spec, const RigSpec& rig, devices::Clock& clock,
                             Member member, const char* kind) {
  const Backend* backend = backendNamed(spec.backend);
  if (!backend || !(backend->*member)) refuse(spec.id, spec.backend, kind);
  return (backend->*member)(spec, rig.source, clock);
}

bool isTwin(const std::string& backend) { return backend == kTwinBackend; }

RigSpec twinPart(RigSpec spec) {
  const auto other = [](const auto& device) { return !isTwin(device.backend); };
  std::erase_if(spec.cameras, other);
  std::erase_if(spec.lights, other);
  std::erase_if(spec.sensors, other);
  std::erase_if(spec.triggers, other);
  return spec;
}

// The twin's devices were made together: each is taken from there in the rig's order.
template <class Device, class Spec, class Make>
void fill(std::vector<std::unique_ptr<Device>>& into, std::vector<std::unique_ptr<Device>> twins,
          const std::vector<Spec>& specs, Make make_one) {
  auto twin = twins.begin();
  for (const Spec& spec : specs)
    into.push_back(isTwin(spec.backend) ? std::move(*twin++) : make_one(spec));
}

}  // namespace

RigSpec onlyThese(RigSpec spec, const std::vector<std::string>& ids) {
  const auto other = [&](const auto& device) {
    return std::find(ids.begin(), ids.end(), device.id) == ids.end();
  };
  std::erase_if(spec.cameras, other);
  std::erase_if(spec.lights, other);
  std::erase_if(spec.sensors, other);
  std::erase_if(spec.triggers, other);
  return spec;
}

std::unique_ptr<devices::Light> makeRelay(const devices::LightSpec& spec, const RigSpec& rig,
                                          devices::Clock& clock) {
  return make<devices::Light>(spec, rig, clock, &Backend::light, "power switch");
}

devices::Rig makeDevices(const RigSpec& spec, const World& world, devices::Clock& clock) {
  devices::Rig twins;
  const RigSpec twin_spec = twinPart(spec);
  if (!twin_spec.cameras.empty() || !twin_spec.lights.empty() || !twin_spec.sensors.empty() ||
      !twin_spec.triggers.empty()) {
    devices::twin::TwinOptions options;
    options.seed = world.seed;
    options.duration = world.duration;
    options.start_utc = world.start_utc;
    options.faults = world.faults;
    twins = devices::twin::makeTwinRig(twin_spec, options, clock);
  }
  devices::Rig rig;
  rig.spec = spec;
  if (!twins.cameras.empty()) rig.spec.patches = twins.spec.patches;  // also those it chose
  fill(rig.cameras, std::move(twins.cameras), spec.cameras, [&](const auto& s) {
    return devices::host::withRungs(
        make<devices::Camera>(s, spec, clock, &Backend::camera, "camera"), rungsOf(s, spec, clock));
  });
  fill(rig.lights, std::move(twins.lights), spec.lights, [&](const auto& s) {
    return make<devices::Light>(s, spec, clock, &Backend::light, "light");
  });
  fill(rig.sensors, std::move(twins.sensors), spec.sensors, [&](const auto& s) {
    return make<devices::Sensor>(s, spec, clock, &Backend::sensor, "sensor");
  });
  fill(rig.triggers, std::move(twins.triggers), spec.triggers, [&](const auto& s) {
    return make<devices::Trigger>(s, spec, clock, &Backend::trigger, "trigger");
  });
  return rig;
}

}  // namespace patina::rig
