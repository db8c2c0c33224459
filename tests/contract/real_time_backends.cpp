// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <cstdlib>

#include "devices/gphoto2/gphoto2.h"
#include "devices/scaled_clock.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "tests/contract/backends.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

constexpr double kSpeed = 10;  // a camera's clock is read until it ticks: a tenth of a second then

RealClock& realClock() {
  static RealClock clock;
  return clock;
}

struct DslrWorld {
  explicit DslrWorld(Clock& clock) : camera(twin::dslr::dslrWorld(clock), options()) {
    // As the process of a driver is kept.
    std::signal(SIGPIPE, SIG_IGN);
    ::setenv("HOME", home.path().c_str(), 1);
  }
  static twin::dslr::DslrOptions options() {
    twin::dslr::DslrOptions o;
    o.serial = "1001";
    return o;
  }
  TempFolder home = TempFolder::inMemory();
  twin::dslr::Dslr camera;
  twin::dslr::PtpIpServer server{camera};
};

RigUnderTest makeGphoto2Ptpip() {
  RigUnderTest made;
  made.real = std::make_unique<ScaledClock>(realClock(), kSpeed);
  made.lag = 2s;
  made.jitter = 1s;
  auto world = std::make_shared<DslrWorld>(*made.real);
  CameraSpec spec;
  spec.id = "cam0";
  spec.backend = "gphoto2";
  spec.serial = "1001";
  spec.settings = {{"host", "127.0.0.1:" + std::to_string(world->server.port())},
                   {"format", "raw+jpeg"},
                   {"raw_extension", "dng"},
                   {"exposure_min", "1/300"},
                   {"cycle", "0.2s"}};
  made.rig.cameras.push_back(gphoto2::makeCamera(spec, "rig.toml", *made.real));
  made.world = std::move(world);
  return made;
}

}  // namespace

std::vector<Backend> realTimeBackends() { return {{"Gphoto2Ptpip", makeGphoto2Ptpip}}; }

}  // namespace patina::testing
