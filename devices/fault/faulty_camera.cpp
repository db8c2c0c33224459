// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <utility>

#include "devices/fault/fault_script.h"
#include "devices/fault/faulty_devices.h"
#include "devices/fault/spoil_picture.h"
#include "processing/image/random.h"

namespace patina::devices {
namespace {

class FaultyCamera final : public Camera {
 public:
  FaultyCamera(std::unique_ptr<Camera> camera, FaultScript script)
      : camera_(std::move(camera)), script_(std::move(script)) {}

  const CameraCaps& caps() const override { return camera_->caps(); }

  Result<Applied> configure(const Exposure& exposure) override {
    if (auto refusal = gate("configure")) return tl::make_unexpected(*refusal);
    return camera_->configure(exposure);
  }

  Result<Ticket> trigger(const ShotRequest& request) override {
    if (auto refusal = gate("trigger")) return tl::make_unexpected(*refusal);
    // A camera that would refuse anyway is not asked whether it is busy.
    if (ready_ && !armed_ && script_.take(FaultKind::kBusy)) {
      return tl::make_unexpected(error(Errc::kBusy, "trigger", "busy"));
    }
    Result<Ticket> ticket = camera_->trigger(request);
    if (ticket) armed_ = *ticket;
    return ticket;
  }

  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    if (auto loss = lossGate("collect")) return tl::make_unexpected(*loss);
    if (trouble_ == Trouble::kNone && armed_ && armed_->key == ticket.key) {
      if (const auto hang = script_.take(FaultKind::kHang)) enter(Trouble::kHung, hang->end);
    }
    if (trouble_ != Trouble::kNone) return noPicture(deadline);
    auto frames = camera_->collect(ticket, deadline);
    if (!frames) return frames;
    armed_.reset();
    if (script_.take(FaultKind::kLate)) {
      late_.insert(late_.end(), frames->begin(), frames->end());
      enter(Trouble::kUnanswered, script_.clock().mono());
      return noPicture(deadline);
    }
    spoil(*frames);
    frames->insert(frames->begin(), late_.begin(), late_.end());
    late_.clear();
    return frames;
  }

  Result<void> release(const RawFrame& frame) override {
    if (auto refusal = gate("release")) return tl::make_unexpected(*refusal);
    return camera_->release(frame);
  }

  Result<std::vector<CameraEvent>> poll() override {
    if (auto refusal = gate("poll")) return tl::make_unexpected(*refusal);
    return camera_->poll();
  }

  Result<void> recover(Rung rung) override {
    startLoss();
    const bool over = script_.clock().mono() >= end_;
    if (trouble_ == Trouble::kLost && !(over && rung >= Rung::kReset)) {
      return tl::make_unexpected(error(Errc::kLost, "recover", "still gone"));
    }
    if (trouble_ == Trouble::kHung && !(over && rung >= Rung::kReopen)) {
      return tl::make_unexpected(hungCall("recover"));
    }
    Result<void> recovered = camera_->recover(rung);
    if (!recovered) return recovered;
    ready_ = true;
    trouble_ = Trouble::kNone;
    armed_.reset();
    if (rung == Rung::kPowerCycle) late_.clear();  // its memory is empty now
    return recovered;
  }

 private:
  enum class Trouble { kNone, kHung, kLost, kUnanswered };

  Error error(Errc code, const char* call, const char* why) const {
    return {code, "fault '" + caps().id + "': " + call + ": " + why};
  }

  void enter(Trouble trouble, MonoTime end) {
    trouble_ = trouble;
    end_ = end;
  }

  Error hungCall(const char* call) {
    script_.clock().sleepUntil(script_.clock().mono() + kHungCall, {});
    return error(Errc::kTimeout, call, "hangs");
  }

  tl::unexpected<Error> noPicture(MonoTime deadline) {
    script_.clock().sleepUntil(deadline, {});
    return tl::make_unexpected(error(Errc::kTimeout, "collect", "no picture by the deadline"));
  }

  void startLoss() {
    if (trouble_ == Trouble::kLost) return;
    if (const auto loss = script_.take(FaultKind::kLost)) enter(Trouble::kLost, loss->end);
  }

  std::optional<Error> lossGate(const char* call) {
    startLoss();
    if (trouble_ != Trouble::kLost) return std::nullopt;
    return error(Errc::kLost, call, "not there");
  }

  std::optional<Error> gate(const char* call) {
    if (auto loss = lossGate(call)) return loss;
    if (trouble_ == Trouble::kHung) return hungCall(call);
    if (trouble_ == Trouble::kUnanswered) {
      return error(Errc::kRefused, call, "state unknown after a timeout; recover first");
    }
    return std::nullopt;
  }

  void spoil(std::vector<RawFrame>& frames) {
    std::vector<Bytes> taken;
    if (script_.plans(FaultKind::kStaleFrame)) {
      for (const RawFrame& frame : frames) taken.push_back(frame.bytes);
    }
    if (frames.empty()) return;
    if (previous_.size() == frames.size() && script_.take(FaultKind::kStaleFrame)) {
      for (std::size_t i = 0; i < frames.size(); ++i) frames[i].bytes = previous_[i];
    }
    previous_ = std::move(taken);
    if (script_.take(FaultKind::kWrongSize)) {
      for (RawFrame& frame : frames) {
        if (auto small = shrinkPicture(frame.bytes)) replace(frame, std::move(*small));
      }
    }
    if (const auto due = script_.take(FaultKind::kCorruptBytes)) {
      RawFrame& frame = pick(frames, due->seed);
      if (!frame.bytes.empty()) frame.bytes = changeBlock(std::move(frame.bytes), due->seed);
    }
    if (const auto due = script_.take(FaultKind::kPartialFile)) {
      RawFrame& frame = pick(frames, due->seed);
      frame.declared_bytes = static_cast<std::int64_t>(frame.bytes.size());
      frame.bytes = cutShort(std::move(frame.bytes), due->seed);
    }
    if (script_.take(FaultKind::kDuplicate))
      frames.insert(frames.begin(), RawFrame(frames.front()));
  }

  static RawFrame& pick(std::vector<RawFrame>& frames, std::uint64_t seed) {
    return frames[uniformBelow(hashSeed(seed, 7), frames.size())];
  }

  // A camera that sends a small picture says so: its declared length agrees.
  static void replace(RawFrame& frame, Bytes bytes) {
    if (frame.declared_bytes) frame.declared_bytes = static_cast<std::int64_t>(bytes.size());
    frame.bytes = std::move(bytes);
  }

  std::unique_ptr<Camera> camera_;
  FaultScript script_;
  Trouble trouble_ = Trouble::kNone;
  MonoTime end_;
  bool ready_ = false;  // was opened once
  std::optional<Ticket> armed_;
  std::vector<RawFrame> late_;
  std::vector<Bytes> previous_;  // of the last shot, kept only when a stale frame is planned
};

}  // namespace

std::unique_ptr<Camera> withFaults(std::unique_ptr<Camera> camera, const FaultPlan& plan,
                                   MonoTime start, Clock& clock, FaultReport* report) {
  FaultScript script(plan, camera->caps().id, start, clock, report);
  return std::make_unique<FaultyCamera>(std::move(camera), std::move(script));
}

}  // namespace patina::devices
