// SPDX-License-Identifier: GPL-3.0-or-later
// What the ladder's rungs cost in software: a hosted gphoto2 driver and the virtual DSLR over
// PTP/IP, from the order to a camera whose settings are applied and read back. A body's own delays
// (USB reset, power) come on top.
#include <benchmark/benchmark.h>

#include "capture/app/rig/host_devices.h"
#include "devices/twin/dslr/ptpip_server.h"
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

}  // namespace
}  // namespace patina::devices
