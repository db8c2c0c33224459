// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/contract/backends.h"

#include <cstdlib>

#include "capture/app/rig/host_devices.h"
#include "devices/fault/faulty_devices.h"
#include "devices/libcamera/pipeline_camera.h"
#include "devices/network/network.h"
#include "devices/twin/twin.h"
#include "devices/v4l2/v4l2_camera.h"
#include "tests/contract/stub_devices.h"
#include "tests/devices/libcamera/fake_pipeline.h"
#include "tests/support/loopback/snapshots.h"
#include "tests/support/v4l2/v4l2_testbed.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

// Every backend's rig has the same ids, so that one fault plan fits all.
constexpr const char* kTwinRig = R"(
camera = [{ id = "cam0", backend = "twin", settings = { format = "FORMAT" } }]
light = [{ id = "key", backend = "twin" }]
sensor = [{ id = "lux0", backend = "twin", quantity = "illuminance" },
          { id = "air0", backend = "twin", quantity = "temperature" }]
trigger = [{ id = "shutter", backend = "twin" }]
[twin]
size = "64x48"
)";

RigUnderTest makeStub() {
  RigUnderTest made{std::make_unique<VirtualClock>(kStart), {}};
  made.rig.cameras.push_back(makeStubCamera("cam0", *made.clock));
  made.rig.lights.push_back(makeStubLight("key"));
  made.rig.sensors.push_back(makeStubSensor("lux0", *made.clock));
  return made;
}

RigUnderTest makeTwin(const std::string& format) {
  RigUnderTest made{std::make_unique<VirtualClock>(kStart), {}};
  std::string toml = kTwinRig;
  toml.replace(toml.find("FORMAT"), 6, format);
  twin::TwinOptions options;
  options.duration = 24h;
  options.start_utc = kStart;
  made.rig = twin::makeTwinRig(parseRig(toml, "twin.toml"), options, *made.clock);
  return made;
}

// The whole twin in a process of its own, which is told the time.
RigUnderTest makeHostedTwin() {
  RigUnderTest made{std::make_unique<VirtualClock>(kStart), {}};
  std::string toml = kTwinRig;
  toml.replace(toml.find("FORMAT"), 6, "dng");
  toml += "hosted = true\n";
  rig::World world;
  world.duration = 24h;
  world.start_utc = kStart;
  made.rig = rig::openHosted(parseRig(toml, "twin.toml"), world, *made.clock,
                             {std::getenv("PATINA_PROGRAM"), "device-host"});
  return made;
}

CameraSpec camera(const char* backend, std::map<std::string, std::string> settings) {
  CameraSpec spec;
  spec.id = "cam0";
  spec.backend = backend;
  spec.settings = std::move(settings);
  return spec;
}

// The other devices of these rigs are the stub's.
RigUnderTest withCamera(std::unique_ptr<Camera> (*make)(Clock&, std::shared_ptr<void>&),
                        Nanoseconds lag) {
  RigUnderTest made = makeStub();
  made.lag = lag;
  made.rig.cameras.clear();
  made.rig.cameras.push_back(make(*made.clock, made.world));
  return made;
}

// The simulated driver's frames come in virtual time too: the clock moves while the camera waits.
struct V4l2World {
  explicit V4l2World(Clock& clock) : webcam(clock) { testbed.plugIn(webcam, 0, 1); }
  SimulatedCamera webcam;
  V4l2Testbed testbed;
};

RigUnderTest makeV4l2() {
  return withCamera(
      [](Clock& clock, std::shared_ptr<void>& world) -> std::unique_ptr<Camera> {
        world = std::make_shared<V4l2World>(clock);
        return std::make_unique<v4l2::V4l2Camera>(
            camera("v4l2", {{"size", "64x48"}, {"exposure_max", "500ms"}}), "rig.toml", clock,
            [] { return Nanoseconds{}; });
      },
      2s);
}

// The library's place is taken by a pipeline in virtual time.
RigUnderTest makeLibcamera() {
  return withCamera(
      [](Clock& clock, std::shared_ptr<void>& world) -> std::unique_ptr<Camera> {
        auto sensor = std::make_shared<FakeSensor>(smallSensor());
        world = sensor;
        CameraSpec spec = camera("libcamera", {});
        spec.serial = "/base/imx477";
        return std::make_unique<libcamera::PipelineCamera>(
            spec, libcamera::readCameraSettings(spec, "rig.toml"), makeFakePipeline(*sensor, clock),
            clock);
      },
      2s);
}

// The answers take real time, of which the virtual clock knows nothing.
struct SnapshotWorld {
  std::uint64_t number = 0;
  LoopbackServer server{[this](Peer& peer) {
    peer.receiveHead();
    peer.send(ok(jpeg(++number)));
  }};
};

RigUnderTest makeNetworkSnapshot() {
  return withCamera(
      [](Clock& clock, std::shared_ptr<void>& world) {
        auto server = std::make_shared<SnapshotWorld>();
        world = server;
        return network::makeCamera(camera("network", {{"url", "http://" + server->server.address()},
                                                      {"fixed_exposure", "1/100"}}),
                                   "rig.toml", clock);
      },
      2s);
}

}  // namespace

RigUnderTest makeWithFaults(const Backend& backend, const FaultPlan& plan) {
  RigUnderTest made = backend.make();
  made.rig = withFaults(std::move(made.rig), plan, made.clock->mono(), *made.clock);
  return made;
}

std::vector<Backend> bareBackends() {
  return {{"Stub", makeStub},
          {"TwinDng", [] { return makeTwin("dng"); }},
          {"TwinRawAndJpeg", [] { return makeTwin("raw+jpeg"); }}};
}

std::vector<Backend> bareAndWrappedBackends() {
  std::vector<Backend> all = bareBackends();
  all.push_back({"HostedTwin", makeHostedTwin});
  all.push_back({"Libcamera", makeLibcamera});
  all.push_back({"NetworkSnapshot", makeNetworkSnapshot});
  if (underUmockdev()) all.push_back({"V4l2", makeV4l2});
  FaultPlan far;
  for (const char* device : {"cam0", "key", "lux0"}) {
    for (const FaultKind kind : {FaultKind::kLost, FaultKind::kHang, FaultKind::kStaleFrame}) {
      Fault fault;
      fault.at = 24h * 3000;
      fault.device = device;
      fault.kind = kind;
      far.faults.push_back(fault);
    }
  }
  for (const Backend& bare : bareBackends()) {
    all.push_back({bare.name + "Wrapped", [bare, far] { return makeWithFaults(bare, far); }});
  }
  return all;
}

}  // namespace patina::testing
