// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/camera_worker.h"

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <vector>

namespace patina::capture {

void Doorbell::ring() {
  std::stop_source rung;
  {
    const std::lock_guard lock(mutex_);
    rung = rung_;
  }
  rung.request_stop();
}

// A ring between the question and the sleep ends the sleep: the bell is set before the question.
bool Doorbell::wait(devices::Clock& clock, MonoTime deadline, const std::function<bool()>& done) {
  while (!done()) {
    std::stop_token token;
    {
      const std::lock_guard lock(mutex_);
      rung_ = std::stop_source();
      token = rung_.get_token();
    }
    if (done()) return true;
    if (clock.sleepUntil(deadline, token) == devices::Wake::kDue) return done();
  }
  return true;
}

// Shared by worker and thread: the last of them to go frees it.
struct CameraWorker::State {
  devices::Camera* camera = nullptr;
  devices::Clock* clock = nullptr;
  std::shared_ptr<Doorbell> bell;
  std::mutex mutex;  // guards what follows
  std::condition_variable posted;
  std::deque<Job> jobs;
  Doing doing;
  bool quit = false, ended = false;
  std::unique_ptr<devices::Camera> kept;  // taken from a session that could not wait

  bool idle() {
    const std::lock_guard lock(mutex);
    return doing.call == nullptr;
  }
  void serve();
};

void CameraWorker::State::serve() {
  std::unique_lock lock(mutex);
  while (true) {
    posted.wait(lock, [this] { return quit || !jobs.empty(); });
    if (quit) break;
    {
      const Job job = std::move(jobs.front());
      jobs.pop_front();
      doing = {job.name, clock->mono()};
      lock.unlock();
      job.make(*camera);
    }
    lock.lock();
    doing = {};
    bell->ring();
  }
  jobs.clear();
  auto camera_to_close = std::move(kept);
  lock.unlock();
  camera_to_close.reset();  // where its calls were made
  lock.lock();
  ended = true;
}

namespace {

struct StillOut {
  std::thread thread;
  std::shared_ptr<CameraWorker::State> state;
};
struct Yard {
  std::mutex mutex;
  std::vector<StillOut> threads;
};
// Never destroyed: a thread in it may run until the process is gone.
Yard& yard() {
  static Yard* const kYard = new Yard;
  return *kYard;
}

}  // namespace

CameraWorker::CameraWorker(std::unique_ptr<devices::Camera>& place, devices::Clock& clock,
                           std::shared_ptr<Doorbell> bell, Nanoseconds patience)
    : place_(place), clock_(clock), patience_(patience), state_(std::make_shared<State>()) {
  state_->camera = place.get();
  state_->clock = &clock;
  state_->bell = std::move(bell);
  if (!clock.threadSafe()) return;
  thread_ = std::thread([state = state_] { state->serve(); });
  const std::string name = ("cam " + place->caps().id).substr(0, 15);  // the kernel's limit
  pthread_setname_np(thread_.native_handle(), name.c_str());
}

CameraWorker::~CameraWorker() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->quit = true;
  }
  state_->posted.notify_one();
  const MonoTime until = clock_.mono() + patience_;
  state_->bell->wait(clock_, until, [this] { return state_->idle(); });
  bool out = false;
  {
    const std::lock_guard lock(state_->mutex);
    out = state_->doing.call != nullptr;
    if (out) state_->kept = std::move(place_);
  }
  if (out) {
    const std::lock_guard lock(yard().mutex);
    yard().threads.push_back({std::move(thread_), state_});
  } else {
    thread_.join();
  }
}

void CameraWorker::enqueue(Job job) {
  if (!thread_.joinable()) return job.make(*state_->camera);
  {
    const std::lock_guard lock(state_->mutex);
    state_->jobs.push_back(std::move(job));
  }
  state_->posted.notify_one();
}

CameraWorker::Doing CameraWorker::doing() const {
  const std::lock_guard lock(state_->mutex);
  return state_->doing;
}

int callsStillOut() {
  const std::lock_guard lock(yard().mutex);
  std::erase_if(yard().threads, [](StillOut& out) {
    {
      const std::lock_guard of_state(out.state->mutex);
      if (!out.state->ended) return false;
    }
    out.thread.join();
    return true;
  });
  return static_cast<int>(yard().threads.size());
}

}  // namespace patina::capture
