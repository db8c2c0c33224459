// SPDX-License-Identifier: GPL-3.0-or-later
// host_victim FAULT --fd N: a device host with one stub camera, lamp, sensor and shutter line whose
// driver does what drivers do. FAULT: none, hang (in collect), hang_once FILE, crash (in collect),
// leak (16 MB a shot), mad (garbage for an answer), stop (the whole process stands still), slow
// (opening takes 300 ms), bad_file, changed FILE (settings are others after a
// restart), keyed FILE (for a caller with that key, gone when silent for a second).
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "devices/host/listener.h"
#include "devices/host/seal.h"
#include "tests/contract/stub_devices.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;

class Moody final : public Camera {
 public:
  Moody(std::string fault, std::string file, Clock& clock)
      : fault_(std::move(fault)),
        file_(std::move(file)),
        clock_(clock),
        camera_(patina::testing::makeStubCamera("cam0", clock)) {}
  const CameraCaps& caps() const override { return camera_->caps(); }
  Result<Applied> configure(const Exposure& exposure) override {
    auto applied = camera_->configure(exposure);
    if (applied && fault_ == "changed" && !firstTime()) applied->exposure.iso.value *= 2;
    return applied;
  }
  Result<Ticket> trigger(const ShotRequest& request) override { return camera_->trigger(request); }
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    if (fault_ == "hang" || (fault_ == "hang_once" && firstTime())) pause();
    if (fault_ == "crash") std::raise(SIGSEGV);
    if (fault_ == "stop") std::raise(SIGSTOP);
    if (fault_ == "leak") std::memset(new char[16 << 20], 1, 16 << 20);
    if (fault_ == "mad") {
      const char noise[] = "\x08\0\0\0abcdefgh";
      static_cast<void>(write(3, noise, sizeof noise - 1));
    }
    auto frames = camera_->collect(ticket, deadline);
    if (frames && fault_ == "bad_file") (*frames)[0].bytes.resize(20);
    return frames;
  }
  Result<void> release(const RawFrame& frame) override { return camera_->release(frame); }
  Result<std::vector<CameraEvent>> poll() override { return camera_->poll(); }
  Result<void> recover(Rung rung) override {
    if (fault_ == "slow") clock_.sleepUntil(clock_.mono() + 300ms, {});
    return camera_->recover(rung);
  }

 private:
  // Of all processes with this file.
  bool firstTime() const {
    const bool first = access(file_.c_str(), F_OK) != 0;
    if (first) std::ofstream(file_.c_str()) << "was here";
    return first;
  }

  std::string fault_, file_;
  Clock& clock_;
  std::unique_ptr<Camera> camera_;
};

class Line final : public Trigger {
 public:
  explicit Line(Clock& clock) : clock_(clock) {}
  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override { return clock_.mono(); }
  Result<void> recover() override { return {}; }

 private:
  std::string id_ = "line";
  Clock& clock_;
};

int run(int argc, char** argv) {
  const std::string fault = argc > 1 ? argv[1] : "none";
  const std::string file = argc > 4 ? argv[2] : "";
  Channel channel{Descriptor(3)};
  const DeviceMaker make = [&](const Hello&, Clock& clock) {
    Rig rig;
    rig.cameras.push_back(std::make_unique<Moody>(fault, file, clock));
    rig.lights.push_back(patina::testing::makeStubLight("key"));
    rig.sensors.push_back(patina::testing::makeStubSensor("air", clock));
    rig.triggers.push_back(std::make_unique<Line>(clock));
    return rig;
  };
  if (fault == "keyed") return serveCaller(channel, readKey(file), make, {}, 1s) ? 0 : 1;
  serve(channel, make);
  return 0;
}

}  // namespace
}  // namespace patina::devices::host

int main(int argc, char** argv) { return patina::devices::host::run(argc, argv); }
