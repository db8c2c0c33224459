// SPDX-License-Identifier: GPL-3.0-or-later
// How long the calls of a hosted camera take, against the deadlines of their kinds.
#pragma once

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "devices/camera.h"

namespace patina::testing {

struct CallDeadlines {
  Nanoseconds call;     // configure, trigger, release; and the most that a collect is given
  Nanoseconds opening;  // of recover(), and of poll(), which may start the process anew
};

// Thread-safe.
class CallTimes {
 public:
  void took(const std::string& call, Nanoseconds time, Nanoseconds deadline) {
    const std::lock_guard lock(mutex_);
    Kind& kind = kinds_[call];
    ++kind.calls;
    kind.longest = std::max(kind.longest, time);
    kind.latest = std::max(kind.latest, time - deadline);
  }
  // The longest that a call took beyond its deadline; negative: within.
  Nanoseconds latest() const {
    const std::lock_guard lock(mutex_);
    Nanoseconds latest = -std::chrono::hours(1);
    for (const auto& [call, kind] : kinds_) latest = std::max(latest, kind.latest);
    return latest;
  }
  // "collect 812 calls, longest 0.271 s; configure ..."
  std::string text() const {
    const std::lock_guard lock(mutex_);
    std::string text;
    for (const auto& [call, kind] : kinds_) {
      char line[100];
      std::snprintf(line, sizeof line, "%s%s %d calls, longest %.3f s", text.empty() ? "" : "; ",
                    call.c_str(), kind.calls, toSeconds(kind.longest));
      text += line;
    }
    return text;
  }

 private:
  struct Kind {
    int calls = 0;
    Nanoseconds longest{}, latest = -std::chrono::hours(1);
  };
  mutable std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
};

class TimedCamera final : public devices::Camera {
  template <class Call>
  auto timed(const char* name, Nanoseconds deadline, Call call) {
    const MonoTime begun = clock_.mono();
    auto answer = call();
    times_->took(name, clock_.mono() - begun, deadline);
    return answer;
  }

 public:
  TimedCamera(std::unique_ptr<devices::Camera> camera, CallDeadlines deadlines,
              devices::Clock& clock, std::shared_ptr<CallTimes> times)
      : camera_(std::move(camera)),
        deadlines_(deadlines),
        clock_(clock),
        times_(std::move(times)) {}
  const devices::CameraCaps& caps() const override { return camera_->caps(); }
  devices::Result<devices::Applied> configure(const devices::Exposure& e) override {
    return timed("configure", deadlines_.call, [&] { return camera_->configure(e); });
  }
  devices::Result<devices::Ticket> trigger(const devices::ShotRequest& r) override {
    return timed("trigger", deadlines_.call, [&] { return camera_->trigger(r); });
  }
  devices::Result<std::vector<devices::RawFrame>> collect(const devices::Ticket& t,
                                                          MonoTime deadline) override {
    const MonoTime now = clock_.mono();
    const MonoTime by = std::clamp(deadline, now, now + deadlines_.call);
    return timed("collect", by - now, [&] { return camera_->collect(t, by); });
  }
  devices::Result<void> release(const devices::RawFrame& f) override {
    return timed("release", deadlines_.call, [&] { return camera_->release(f); });
  }
  devices::Result<std::vector<devices::CameraEvent>> poll() override {
    return timed("poll", deadlines_.opening, [&] { return camera_->poll(); });
  }
  devices::Result<void> recover(devices::Rung rung) override {
    return timed("recover", deadlines_.opening, [&] { return camera_->recover(rung); });
  }

 private:
  std::unique_ptr<devices::Camera> camera_;
  CallDeadlines deadlines_;
  devices::Clock& clock_;
  std::shared_ptr<CallTimes> times_;
};

}  // namespace patina::testing
