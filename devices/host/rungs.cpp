// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/rungs.h"

namespace patina::devices::host {
namespace {

class CameraWithRungs final : public Camera {
 public:
  CameraWithRungs(std::unique_ptr<Camera> camera, Rungs rungs)
      : camera_(std::move(camera)), rungs_(std::move(rungs)) {}

  const CameraCaps& caps() const override { return camera_->caps(); }
  Result<Applied> configure(const Exposure& exposure) override {
    return camera_->configure(exposure);
  }
  Result<Ticket> trigger(const ShotRequest& request) override { return camera_->trigger(request); }
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    return camera_->collect(ticket, deadline);
  }
  Result<void> release(const RawFrame& frame) override { return camera_->release(frame); }
  Result<std::vector<CameraEvent>> poll() override { return camera_->poll(); }
  Result<void> recover(Rung rung) override {
    const auto& own = rung == Rung::kReset ? rungs_.reset : rungs_.power_cycle;
    if (rung < Rung::kReset || !own) return camera_->recover(rung);
    auto done = own();
    auto opened = camera_->recover(Rung::kReopen);  // it may have come back by itself
    return opened || done ? opened : done;
  }

 private:
  std::unique_ptr<Camera> camera_;
  Rungs rungs_;
};

}  // namespace

std::unique_ptr<Camera> withRungs(std::unique_ptr<Camera> camera, Rungs rungs) {
  return std::make_unique<CameraWithRungs>(std::move(camera), std::move(rungs));
}

}  // namespace patina::devices::host
