// SPDX-License-Identifier: GPL-3.0-or-later
// `patina capture` on a DSLR at the end of a USB cable, as its user runs it: libusb and libgphoto2
// are the real ones, in a driver's process of its own; the bus below them is simulated, the lamps
// hang on Art-Net.
#include <gmock/gmock.h>

#include "capture/app/rig/host_devices.h"
#include "db/archive_reader.h"
#include "devices/twin/dslr/artnet_lamps.h"
#include "tests/capture/app/json_answer.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/matchers.h"
#include "tests/support/places.h"
#include "tests/support/usb/usb_camera.h"
#include "tests/system/dslr_oracle.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using devices::twin::dslr::ArtNetLamps;
using devices::twin::dslr::Dslr;
using devices::twin::dslr::DslrFault;
using devices::twin::dslr::DslrFaultKind;
using devices::twin::dslr::DslrOptions;
using devices::twin::dslr::Operation;

constexpr int kSteps = 2, kShotsAStep = 4;  // two lamps, two exposures
constexpr int kIntervalS = 10;              // on two processors others may be first

// One a process: programs look at it from the first call on.
UsbBus& bus() {
  static UsbBus* const kBus = new UsbBus;
  return *kBus;
}

class CaptureOnUsb : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!UsbBus::isThere()) GTEST_SKIP() << "not run by umockdev-wrapper";
    bus();
  }
  static DslrOptions body(const std::string& serial) {
    DslrOptions options;
    options.serial = serial;
    return options;
  }
  std::string light(const std::string& id, int channel) const {
    return "[[light]]\nid = \"" + id + "\"\nbackend = \"artnet\"\naddress = \"127.0.0.1\"\n" +
           "settings = { port = " + std::to_string(lamps_.port()) +
           ", channel = " + std::to_string(channel) + " }\n";
  }
  JsonAnswer capture(const std::string& format) {
    writeFile(folder_ / "rig.toml",
              "name = \"bench\"\n[[camera]]\nid = \"cam0\"\nbackend = \"gphoto2\"\n"
              "serial = \"1001\"\nsettings = { format = \"" +
                  format + "\", cycle = \"100ms\" }\n" + light("key", 1) + light("fill", 2));
    writeFile(folder_ / "plan.toml",
              "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"" +
                  std::to_string(kIntervalS) + "s\"\nduration = \"" +
                  std::to_string(kIntervalS * kSteps) +
                  "s\"\n[[sweep]]\nlights = [[\"key\"],[\"fill\"]]\n"
                  "exposures = [\"1/100\", \"1/50\"]\n"
                  "[light_check]\nmode = \"uncontrolled\"\nsettle = \"100ms\"\n");
    return answerOf(runPatina({"capture", folder_ / "plan.toml", "--archive", archive_, "--json"}));
  }
  std::string eventsOf(const std::string& run_id) const {
    std::string text;
    for (const db::EventRow& event : db::ArchiveReader(archive_).events(run_id))
      text.append(formatUtc(event.utc)).append(" " + event.kind + " ").append(event.detail + "\n");
    return text;
  }
  // Every frame is what its row says, and every hash right.
  DslrVerdict expectTrue(const JsonAnswer& answer) const {
    const std::string run_id = answer.text("/items/0/run_id");
    DslrVerdict verdict = judge(archive_, {run_id}, camera_.truth(), {"key", "fill"}, 1ms);
    EXPECT_THAT(verdict.broken, ::testing::IsEmpty()) << eventsOf(run_id);
    EXPECT_EQ(verdict.lost_with_power, 0u);
    EXPECT_EQ(runPatina({"archive", "verify", "--archive", archive_}).exit, 0);
    return verdict;
  }

  TempFolder folder_ = TempFolder::inMemory();
  const std::string archive_ = folder_ / "archive";
  devices::RealClock clock_;
  std::shared_ptr<devices::twin::World> world_ = devices::twin::dslr::dslrWorld(clock_);
  Dslr camera_{world_, body("1001")}, brother_{world_, body("1002")};
  ArtNetLamps lamps_{world_, {{0, 1}, {0, 2}}};
};

// The one with the lower number on the bus is not the one that the rig names.
TEST_F(CaptureOnUsb, APlanGivesEveryPairOfFilesOfTheCameraThatTheRigNames) {
  const UsbCamera other(bus(), brother_, 1), ours(bus(), camera_, 2);
  const JsonAnswer answer = capture("raw+jpeg");
  EXPECT_EQ(answer.number("/items/0/captured"), kSteps) << eventsOf(answer.text("/items/0/run_id"));
  const DslrVerdict verdict = expectTrue(answer);
  EXPECT_EQ(verdict.frames, 2u * kSteps * kShotsAStep);
  EXPECT_LE(verdict.on_card, 2u);  // whose release the session's end overtook
  EXPECT_TRUE(brother_.truth().pictures.empty());
}

// A stalled pipe hangs libgphoto2 beyond a step: its process is killed, and the run goes on.
TEST_F(CaptureOnUsb, AStalledPipeAndACableThatIsPulledLoseNoPicture) {
  const UsbCamera ours(bus(), camera_, 1);
  for (const DslrFaultKind kind : {DslrFaultKind::kClose, DslrFaultKind::kReset}) {
    DslrFault fault;
    fault.kind = kind;
    fault.operation = Operation::kGetObject;
    fault.amount = 0.5;
    camera_.order(fault);
  }
  expectTrue(capture("jpeg"));
  EXPECT_EQ(camera_.truth().faults.size(), 2u);
  EXPECT_GE(camera_.truth().sessions, 2u);
}

// The rung's time in software is printed: the simulated bus takes none.
TEST_F(CaptureOnUsb, AResetOfTheDeviceGivesTheNextShot) {
  const UsbCamera ours(bus(), camera_, 1);
  const devices::RigSpec spec = devices::parseRig(
      "camera = [{ id = 'cam0', backend = 'gphoto2', serial = '1001', settings = { format = "
      "'jpeg' } }]\n",
      "rig.toml");
  devices::Rig rig = rig::openHosted(spec, {}, clock_, {program().string(), "device-host"});
  devices::Camera& camera = *rig.cameras[0];
  ASSERT_THAT(camera.recover(devices::Rung::kReopen), IsOk());
  const MonoTime begun = clock_.mono();
  ASSERT_THAT(camera.recover(devices::Rung::kReset), IsOk());
  ASSERT_THAT(camera.configure({}), IsOk());
  std::printf("USB reset, settings applied and read back: %.3f s\n",
              toSeconds(clock_.mono() - begun));
  EXPECT_EQ(ours.resets(), 1);
  const auto ticket = camera.trigger({"shot", 1});
  ASSERT_THAT(ticket, IsOk());
  EXPECT_THAT(camera.collect(*ticket, clock_.mono() + 10s), IsOk());
}

}  // namespace
}  // namespace patina::testing
