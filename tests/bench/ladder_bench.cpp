// SPDX-License-Identifier: GPL-3.0-or-later
// What the ladder's rungs cost in software: a hosted gphoto2 driver and the virtual DSLR over
// PTP/IP, from the order to a camera whose settings are applied and read back. A body's own delays
// (USB reset, power) come on top.
#include <benchmark/benchmark.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <thread>

#include "capture/app/rig/camera_rungs.h"
#include "capture/app/rig/host_devices.h"
#include "devices/twin/dslr/op_dmx.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "devices/twin/dslr/wire_connection.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/places.h"

namespace patina::devices {
namespace {

void BM_Ladder(benchmark::State& state, Rung rung) {
  RealClock clock;
  twin::dslr::DslrOptions options;
  options.serial = "1001";
  twin::dslr::Dslr body(twin::dslr::dslrWorld(clock), options);
  twin::dslr::PtpIpServer server(body);
  const RigSpec spec = parseRig(
      "camera = [{ id = 'cam0', backend = 'gphoto2', serial = '1001', settings = { format = "
      "'jpeg', host = '127.0.0.1:" +
          std::to_string(server.port()) + "' } }]\n",
      "rig.toml");
  rig::World world;
  Rig rig = rig::openHosted(spec, world, clock, {testing::program(), "device-host"});
  Camera& camera = *rig.cameras[0];
  const Exposure exposure{std::chrono::milliseconds(20), {100}, {8}};
  if (!camera.recover(Rung::kReopen)) return state.SkipWithError("the camera does not open");
  for (auto _ : state)
    if (!camera.recover(rung) || !camera.configure(exposure))
      return state.SkipWithError("the rung does not work");
}
BENCHMARK_CAPTURE(BM_Ladder, drain, Rung::kDrain)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_Ladder, reopen, Rung::kReopen)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_Ladder, new_process, Rung::kReset)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// A relay at the end of Art-Net, whose normally closed contact carries the camera's power.
class Relay {
 public:
  explicit Relay(twin::dslr::Dslr& camera)
      : camera_(camera), thread_([this](const std::stop_token& stop) { run(stop); }) {}
  int port() const { return twin::dslr::portOf(socket_); }
  int cycles() const { return cycles_; }

 private:
  void run(const std::stop_token& stop) {
    bool on = false;
    std::array<std::byte, 1024> buffer;
    while (!stop.stop_requested()) {
      pollfd ready{socket_.fd(), POLLIN, 0};
      if (poll(&ready, 1, 20) <= 0) continue;
      const auto bytes = recv(socket_.fd(), buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (bytes <= 0) continue;
      const auto frame = twin::dslr::parseOpDmx(
          std::span<const std::byte>(buffer).first(static_cast<std::size_t>(bytes)));
      if (!frame || frame->slots.empty()) continue;
      const bool was = std::exchange(on, frame->slots[0] > 127);
      if (on && !was) {
        ++cycles_;
        camera_.turnOff(rig::kPowerOff);
      }
    }
  }

  twin::dslr::Dslr& camera_;
  twin::dslr::Socket socket_ = twin::dslr::bindUdp("127.0.0.1", 0);
  std::atomic<int> cycles_ = 0;
  std::jthread thread_;
};

// Without the 5 s that the hardware is given.
void BM_LadderPowerCycle(benchmark::State& state) {
  RealClock clock;
  twin::dslr::Dslr body(twin::dslr::dslrWorld(clock), {.serial = "1001"});
  twin::dslr::PtpIpServer server(body);
  Relay relay(body);
  const RigSpec spec = parseRig(
      "camera = [{ id = 'cam0', backend = 'gphoto2', serial = '1001', power = 'plug', settings = { "
      "format = 'jpeg', host = '127.0.0.1:" +
          std::to_string(server.port()) +
          "' } }]\n[[power]]\nid = 'plug'\nbackend = 'artnet'\naddress = '127.0.0.1'\n"
          "settings = { port = " +
          std::to_string(relay.port()) + " }\n",
      "rig.toml");
  Rig rig = rig::openHosted(spec, rig::World{}, clock, {testing::program(), "device-host"});
  Camera& camera = *rig.cameras[0];
  if (!camera.recover(Rung::kReopen)) return state.SkipWithError("the camera does not open");
  for (auto _ : state) {
    const MonoTime begun = clock.mono();
    const auto up = camera.recover(Rung::kPowerCycle);
    if (!up || !camera.configure({std::chrono::milliseconds(20), {100}, {8}}))
      return state.SkipWithError(up ? "it does not take its settings" : up.error().what.c_str());
    state.SetIterationTime(toSeconds(clock.mono() - begun - rig::kPowerOff - rig::kPowerOnset));
  }
  state.counters["cycles"] = relay.cycles();
}
BENCHMARK(BM_LadderPowerCycle)->Iterations(3)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace patina::devices
