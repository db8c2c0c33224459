// SPDX-License-Identifier: GPL-3.0-or-later
// Between steps, where a person is heard: to pause, to go on, to shoot now.
#include <algorithm>

#include "capture/running_session.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kAwakeEvery = 15s, kAskEvery = 250ms;

}  // namespace

// Said once when it takes effect and once when it is over, also when a restart lies between.
void Session::watchPause() {
  const bool paused = hooks_.paused && hooks_.paused->load();
  if (paused == status_.paused) return;
  status_.paused = paused;
  tryEvent(paused ? "paused" : "continued", "at step " + std::to_string(state_.next_number));
  tell(paused ? "paused" : "");
}

// In pieces: a manual shot may be asked for, cameras fall asleep, the wall clock may step.
void Session::wait(const Decision& d) {
  const MonoTime until = std::min(d.due_mono, clock_.mono() + kAwakeEvery);
  const Nanoseconds piece = hooks_.shoot_now ? kAskEvery : kAwakeEvery;
  while (clock_.mono() < until && !hooks_.stop.stop_requested()) {
    watchPause();
    if (hooks_.shoot_now && hooks_.shoot_now->exchange(false)) return shootByHand(d);
    state_.awake_mono = clock_.mono();
    runner_.alerts().look(moment());
    if (hooks_.on_alive) hooks_.on_alive();
    try {
      runner_.sleepUntil(std::min(until, clock_.mono() + piece));
    } catch (const db::DiskFull& full) {
      diskIsFull(full.what());
    }
  }
  if (until < d.due_mono) runner_.keepAwake();
}

void Session::shootByHand(const Decision& waiting_for) {
  db::StepRow row;
  row.run_id = run_id_;
  row.due_utc = clock_.utc();
  row.shots_due = runner_.shotsDue();
  if (!diskHasRoom()) return tell("no manual shot: the disk is full");
  shootRow(row, std::max(waiting_for.due_mono, clock_.mono() + plan_.interval));
  tell("manual shot");
}

}  // namespace patina::capture
