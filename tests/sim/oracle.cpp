// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/oracle.h"

#include <algorithm>

#include "processing/image/sha256.h"
#include "tests/sim/oracle_verdict.h"

namespace patina::testing {
namespace {

using devices::Camera;
using devices::Light;
using devices::Result;

class SeenLight final : public Light {
 public:
  SeenLight(std::unique_ptr<Light> light, Oracle& oracle)
      : light_(std::move(light)), oracle_(oracle) {}
  // A twin's lamp goes out with its process.
  ~SeenLight() override { oracle_.lampIs(caps().id, false); }
  const devices::LightCaps& caps() const override { return light_->caps(); }
  Result<void> set(double level) override {
    auto done = light_->set(level);
    if (done) oracle_.lampIs(caps().id, level > 0);
    return done;
  }
  Result<std::optional<bool>> isOn() override { return light_->isOn(); }
  Result<void> recover() override {
    auto done = light_->recover();
    if (done) oracle_.lampIs(caps().id, false);
    return done;
  }

 private:
  std::unique_ptr<Light> light_;
  Oracle& oracle_;
};

class SeenCamera : public Camera {
 public:
  SeenCamera(std::unique_ptr<Camera> camera, Oracle& oracle)
      : camera_(std::move(camera)), oracle_(oracle) {}
  const devices::CameraCaps& caps() const override { return camera_->caps(); }
  Result<devices::Applied> configure(const devices::Exposure& exposure) override {
    auto applied = camera_->configure(exposure);
    if (applied) exposure_ = applied->exposure.time;
    return applied;
  }
  Result<devices::Ticket> trigger(const devices::ShotRequest& request) override {
    return camera_->trigger(request);
  }
  Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& ticket,
                                                 MonoTime deadline) override {
    return camera_->collect(ticket, deadline);
  }
  Result<void> release(const devices::RawFrame& frame) override { return camera_->release(frame); }
  Result<std::vector<devices::CameraEvent>> poll() override { return camera_->poll(); }
  Result<void> recover(devices::Rung rung) override { return camera_->recover(rung); }

 protected:
  std::unique_ptr<Camera> camera_;
  Oracle& oracle_;
  Nanoseconds exposure_{};
};

class TruthOfCamera final : public SeenCamera {
 public:
  using SeenCamera::SeenCamera;
  Result<devices::Ticket> trigger(const devices::ShotRequest& request) override {
    auto ticket = camera_->trigger(request);
    if (ticket) picture_ = oracle_.took(caps().id, exposure_);
    return ticket;
  }
  Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& ticket,
                                                 MonoTime deadline) override {
    auto frames = camera_->collect(ticket, deadline);
    if (frames)
      for (const auto& frame : *frames) oracle_.sawFile(picture_, frame);
    return frames;
  }

 private:
  std::size_t picture_ = 0;
};

class DeliveryOfCamera final : public SeenCamera {
 public:
  using SeenCamera::SeenCamera;
  Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& ticket,
                                                 MonoTime deadline) override {
    auto frames = camera_->collect(ticket, deadline);
    if (frames)
      for (const auto& frame : *frames) oracle_.delivered(caps().id, frame);
    return frames;
  }
};

}  // namespace

void WorldTime::reboot(Nanoseconds off) {
  const Nanoseconds then = now() + off;
  const MonoTime awake = monoFromNs(7'000'000'000);
  begin_ = awake - then;
  ++boots_;
  clock_.reboot(off, "virtual-boot-" + std::to_string(boots_), awake);
}

void Oracle::watchTruth(devices::Rig& rig) {
  burning_.clear();
  for (auto& light : rig.lights) light = std::make_unique<SeenLight>(std::move(light), *this);
  for (auto& camera : rig.cameras)
    camera = std::make_unique<TruthOfCamera>(std::move(camera), *this);
}

void Oracle::watchDelivery(devices::Rig& rig) {
  for (auto& camera : rig.cameras)
    camera = std::make_unique<DeliveryOfCamera>(std::move(camera), *this);
}

void Oracle::lampIs(const std::string& id, bool on) {
  if (on)
    burning_.insert(id);
  else
    burning_.erase(id);
}

std::size_t Oracle::took(const std::string& camera, Nanoseconds exposure) {
  std::string state;
  for (const std::string& lamp : burning_) state += (state.empty() ? "" : "+") + lamp;
  taken_.push_back({camera, state.empty() ? "off" : state, exposure, time_.now()});
  return taken_.size() - 1;
}

void Oracle::sawFile(std::size_t picture, const devices::RawFrame& frame) {
  by_hash_.emplace(sha256(frame.bytes).hex(), picture);
  by_moment_[{taken_[picture].camera, {time_.boots(), frame.mono}}] = picture;
}

void Oracle::delivered(const std::string& camera, const devices::RawFrame& frame) {
  const std::string hash = sha256(frame.bytes).hex();
  const bool again = !delivered_.insert(hash).second;
  const auto moment = by_moment_.find({camera, {time_.boots(), frame.mono}});
  if (again || moment == by_moment_.end()) return;
  for (auto [at, end] = by_hash_.equal_range(hash); at != end; ++at)
    if (at->second == moment->second) return;
  spoilt_.emplace(hash, moment->second);
}

std::vector<const Oracle::Picture*> Oracle::picturesOf(const std::string& hash) const {
  std::vector<const Picture*> found;
  for (const auto* files : {&by_hash_, &spoilt_})
    for (auto [at, end] = files->equal_range(hash); at != end; ++at)
      found.push_back(&taken_[at->second]);
  return found;
}

void Oracle::acknowledged(const db::FrameRow& frame) {
  acks_.push_back({frame.shot_id, frame.file_index, frame.sha256.hex()});
  std::string line =
      "ack " + std::to_string(frame.shot_id) + " file " + std::to_string(frame.file_index) + " of";
  for (const Picture* p : picturesOf(acks_.back().sha256))
    line += " " + p->camera + " " + p->light_state + " at " + std::to_string(p->at.count());
  note(line);
}

void Oracle::note(const std::string& line) {
  log_.push_back(std::to_string(time_.now().count()) + " " + line);
}

std::string Oracle::logHash() const {
  std::string all;
  for (const std::string& line : log_) all += line + "\n";
  return patina::sha256(std::string_view(all)).hex();
}

std::vector<std::string> Oracle::judge(const std::filesystem::path& archive,
                                       const std::string& run_id, UtcTime t0,
                                       const WeekPlan& plan) {
  OracleVerdict verdict(plan, t0);
  verdict.read(archive, run_id);
  for (const Ack& ack : acks_) verdict.acknowledged(ack.shot_id, ack.file_index, ack.sha256);
  verdict.frames([this](const std::string& hash) {
    std::vector<OracleVerdict::Truth> truths;
    for (const Picture* p : picturesOf(hash))
      truths.push_back({p->camera, p->light_state, p->exposure, p->at});
    return truths;
  });
  verdict.steps();
  calm_steps_ = verdict.calmSteps();
  for (const std::string& lamp : burning_) verdict.problem(lamp + " was left burning");
  return verdict.problems();
}

}  // namespace patina::testing
