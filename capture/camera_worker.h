// SPDX-License-Identifier: GPL-3.0-or-later
// One camera's calls on a thread of their own, so that a call that hangs keeps nobody waiting.
//
// Threads: one, the session's, posts calls and reads answers; the calls are made in the order they
// were posted. On a clock of one thread (VirtualClock) there is no worker: post() makes the call at
// once in the caller's thread, and its answer is there when it returns.
// A posted call owns what it needs: it may outlive its session.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "devices/camera.h"
#include "devices/clock.h"

namespace patina::capture {

// Rung by workers when a call has returned. One thread waits.
class Doorbell {
 public:
  void ring();
  // Until `done` says so or `deadline` has passed; what `done` said last.
  bool wait(devices::Clock& clock, MonoTime deadline, const std::function<bool()>& done);

 private:
  std::mutex mutex_;
  std::stop_source rung_;
};

// What a posted call will have answered.
class Pending {
 public:
  bool ready() const { return ready_.load(std::memory_order_acquire); }
  // Nobody wants it any more: a call that has not begun is not made, a late answer is thrown away.
  void drop() { dropped_.store(true, std::memory_order_release); }
  bool dropped() const { return dropped_.load(std::memory_order_acquire); }

 protected:
  std::atomic<bool> ready_{false}, dropped_{false};
};

template <class T>
class Answer final : public Pending {
 public:
  devices::Result<T>& get() { return *result_; }  // once it is ready
  void set(devices::Result<T> result) {
    result_.emplace(std::move(result));
    ready_.store(true, std::memory_order_release);
  }

 private:
  std::optional<devices::Result<T>> result_;
};

class CameraWorker {
 public:
  // Borrows the camera. When one of its calls has not returned `patience` after the worker's end,
  // the camera is taken out of `place`: it lives until that call returns. The clock outlives all.
  CameraWorker(std::unique_ptr<devices::Camera>& place, devices::Clock& clock,
               std::shared_ptr<Doorbell> bell,
               Nanoseconds patience = std::chrono::milliseconds(500));
  ~CameraWorker();
  CameraWorker(const CameraWorker&) = delete;
  CameraWorker& operator=(const CameraWorker&) = delete;

  // An exception of the driver is the answer kLost: nothing is known of its state.
  template <class T>
  std::shared_ptr<Answer<T>> post(const char* name,
                                  std::function<devices::Result<T>(devices::Camera&)> call) {
    auto answer = std::make_shared<Answer<T>>();
    enqueue({name, [answer, call = std::move(call), name](devices::Camera& camera) {
               answer->set(answer->dropped() ? notMade<T>(camera, name)
                                             : guarded<T>(camera, name, call));
             }});
    return answer;
  }

  struct Doing {
    const char* call = nullptr;  // nothing: idle
    MonoTime since;
  };
  Doing doing() const;

  struct State;

 private:
  struct Job {
    const char* name;
    std::function<void(devices::Camera&)> make;
  };
  template <class T>
  static devices::Result<T> notMade(const devices::Camera& camera, const char* name) {
    return devices::fail(devices::Errc::kBusy, "camera '" + camera.caps().id + "': " + name +
                                                   ": given up before it began");
  }
  template <class T>
  static devices::Result<T> guarded(
      devices::Camera& camera, const char* name,
      const std::function<devices::Result<T>(devices::Camera&)>& call) {
    const auto threw = [&](const std::string& what) {
      return devices::fail(devices::Errc::kLost, "camera '" + camera.caps().id + "': " + name +
                                                     ": its driver threw: " + what);
    };
    try {
      return call(camera);
    } catch (const std::exception& error) {
      return threw(error.what());
    } catch (...) {
      return threw("something unknown");
    }
  }
  void enqueue(Job job);

  std::unique_ptr<devices::Camera>& place_;
  devices::Clock& clock_;
  Nanoseconds patience_;
  std::shared_ptr<State> state_;
  std::thread thread_;
};

// Calls that had not returned when their worker ended; those that have are joined by asking. While
// there is one, a process ends by std::_Exit: a thread that wakes up must find nothing destroyed.
int callsStillOut();

}  // namespace patina::capture
