// SPDX-License-Identifier: GPL-3.0-or-later
// Devices that do as the test says, for what the twin cannot do on order.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/light.h"

namespace patina::capture {

// Calls wait at a closed gate, on whatever thread they are. Outlives nobody: shared.
class Gate {
 public:
  void close() {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    if (open_) return;
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
    --waiting_;
  }
  void waitForOne() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  int waiting_ = 0;
};

class FakeCamera final : public devices::Camera {
 public:
  explicit FakeCamera(std::string id = "cam0") {
    caps_.id = std::move(id);
    caps_.size = {16, 12};
    caps_.bits = 8;
    caps_.extensions = {"jpg"};
    caps_.cycle = std::chrono::milliseconds(100);
  }
  const devices::CameraCaps& caps() const override { return caps_; }
  devices::Result<devices::Applied> configure(const devices::Exposure& e) override {
    configured.push_back(e);
    return devices::Applied{applied.value_or(e)};
  }
  devices::Result<devices::Ticket> trigger(const devices::ShotRequest& r) override {
    if (busy) return devices::fail(devices::Errc::kBusy, "busy");
    devices::Ticket t;
    t.key = r.key;
    t.sequence = r.sequence;
    return t;
  }
  devices::Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& t,
                                                          MonoTime) override {
    ++collected;
    hangs->pass();
    devices::RawFrame frame;
    frame.sequence = t.sequence;
    return std::vector<devices::RawFrame>{frame};
  }
  devices::Result<void> release(const devices::RawFrame& frame) override {
    released.push_back(frame);
    return {};
  }
  devices::Result<std::vector<devices::CameraEvent>> poll() override {
    return std::vector<devices::CameraEvent>{};
  }
  devices::Result<void> recover(devices::Rung rung) override {
    rungs.push_back(rung);
    if (hang_in_recover) hangs->pass();
    return {};
  }

  devices::CameraCaps caps_;
  std::optional<devices::Exposure> applied;  // what the hardware does instead
  std::vector<devices::Exposure> configured;
  std::vector<devices::Rung> rungs;
  std::vector<devices::RawFrame> released;
  int collected = 0;
  bool busy = false, hang_in_recover = false;
  std::shared_ptr<Gate> hangs = std::make_shared<Gate>();  // collect and, if asked, recover
};

class FakeLight final : public devices::Light {
 public:
  explicit FakeLight(std::string id, bool confirms = false) {
    caps_.id = std::move(id);
    caps_.confirms = confirms;
  }
  const devices::LightCaps& caps() const override { return caps_; }
  devices::Result<void> set(double to) override {
    if (failures > 0) {
      --failures;
      return devices::fail(devices::Errc::kLost, "light '" + caps_.id + "': gone");
    }
    level = stuck ? level : to;
    return {};
  }
  devices::Result<std::optional<bool>> isOn() override { return std::optional<bool>(level > 0); }
  devices::Result<void> recover() override {
    ++recovered;
    return {};
  }

  devices::LightCaps caps_;
  double level = 0;
  int failures = 0, recovered = 0;
  bool stuck = false;
};

}  // namespace patina::capture
