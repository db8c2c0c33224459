// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/active_run.h"

#include <algorithm>
#include <utility>

namespace patina::daemon {

ActiveRun::ActiveRun(RunObserver& observer, Spawner& spawner, const db::RunRow& run,
                     std::filesystem::path plan)
    : observer_(observer),
      spawner_(spawner),
      run_(run),
      plan_(std::move(plan)),
      paused_(run.state == "paused") {
  view_.id = run.id;
  view_.specimen = run.specimen;
  view_.plan = plan_.string();
  view_.state = run.state;
  view_.status.run_id = run.id;
  view_.interval = run.interval;
}

ActiveRun::~ActiveRun() {
  askToStop();
  join();
}

void ActiveRun::begin(std::function<void(ActiveRun&, const capture::SessionHooks&)> session) {
  join();
  stop_ = std::stop_source();
  abort_ = std::stop_source();
  stopping_ = false;
  shoot_ = false;
  working_ = true;
  {
    const std::lock_guard lock(mutex_);
    view_.active = true;
    view_.trouble.clear();
  }
  observer_.onRun(view());
  thread_ = spawner_.start([this, session = std::move(session)] {
    observer_.onSession(run_.id, Phase::kBegins);
    session(*this, hooks());
    observer_.onSession(run_.id, Phase::kEnds);
    {
      const std::lock_guard lock(mutex_);
      view_.active = false;
    }
    working_ = false;
    observer_.onRun(view());
  });
}

void ActiveRun::join() {
  if (thread_.joinable()) thread_.join();
}

void ActiveRun::askToStop() {
  stopping_ = true;
  stop_.request_stop();
}

void ActiveRun::askToAbort() {
  abort_.request_stop();
  askToStop();
}

RunView ActiveRun::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

void ActiveRun::setState(const std::string& state) {
  const std::lock_guard lock(mutex_);
  view_.state = state;
}

bool ActiveRun::setTrouble(const std::string& trouble) {
  const std::lock_guard lock(mutex_);
  view_.trouble = trouble;
  return std::exchange(told_trouble_, trouble) != trouble;
}

void ActiveRun::setDevices(std::vector<std::string> devices) {
  const std::lock_guard lock(mutex_);
  view_.devices = std::move(devices);
}

capture::SessionHooks ActiveRun::hooks() {
  capture::SessionHooks hooks;
  hooks.on_status = [this](const capture::SessionStatus& status) { take(status); };
  hooks.on_acknowledged = [this](const db::FrameRow& frame) { take(frame); };
  hooks.on_thumbnail = [this](const Sha256& frame, const Bytes& jpeg) {
    observer_.onThumbnail(frame, jpeg);
  };
  hooks.on_shot = [this](const db::ShotRow& shot) { take(shot); };
  hooks.on_step = [this](const db::StepRow& step) { observer_.onStep(step); };
  hooks.on_light = [this](std::span<const db::LightCheckRow> rows) { observer_.onLight(rows); };
  hooks.on_event = [this](const db::EventRow& event) { observer_.onEvent(event); };
  hooks.on_alert = [this](const capture::AlertNews& news) { observer_.onAlert(run_.id, news); };
  hooks.on_alive = [this] { observer_.onSession(run_.id, Phase::kTurns); };
  hooks.paused = &paused_;
  hooks.shoot_now = &shoot_;
  hooks.stop = stop_.get_token();
  hooks.abort = abort_.get_token();
  hooks.keep_state = true;
  return hooks;
}

void ActiveRun::take(const capture::SessionStatus& status) {
  {
    const std::lock_guard lock(mutex_);
    view_.status = status;
    told_trouble_.clear();  // it is at work: the next trouble is a new one
    for (const capture::CameraStatus& camera : status.cameras) {
      const auto known =
          std::find_if(view_.cameras.begin(), view_.cameras.end(),
                       [&](const CameraView& c) { return c.status.id == camera.id; });
      if (known != view_.cameras.end())
        known->status = camera;
      else
        view_.cameras.push_back({camera, 0, 0, {}});
    }
  }
  observer_.onStatus(view());
}

void ActiveRun::take(const db::ShotRow& shot) {
  shot_by_ = shot.device_id;
  {
    const std::lock_guard lock(mutex_);
    const auto known = std::find_if(view_.cameras.begin(), view_.cameras.end(),
                                    [&](const CameraView& c) { return c.status.id == shot_by_; });
    CameraView& camera = known != view_.cameras.end() ? *known : view_.cameras.emplace_back();
    camera.status.id = shot_by_;
    ++(shot.state == db::ShotState::kCaptured ? camera.captured : camera.failed);
  }
  observer_.onShot(shot);
}

// Its shot was settled just before.
void ActiveRun::take(const db::FrameRow& frame) {
  {
    const std::lock_guard lock(mutex_);
    for (CameraView& camera : view_.cameras)
      if (camera.status.id == shot_by_) camera.newest = frame;
  }
  observer_.onFrame(run_.id, shot_by_, frame);
}

}  // namespace patina::daemon
