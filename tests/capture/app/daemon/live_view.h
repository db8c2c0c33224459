// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "capture/app/daemon/run_view.h"

namespace patina::daemon {

// A run at work: one camera shoots, the other is down.
inline RunView liveView() {
  RunView view;
  view.id = view.status.run_id = "20240501T120000Z-card";
  view.specimen = "card";
  view.state = "running";
  view.active = true;
  view.devices = {"cam0", "cam1", "key"};
  view.status.step = 12;
  view.status.steps = 1008;
  view.status.captured = 11;
  view.status.missed = 1;
  view.status.now_utc = parseUtc("2024-05-01T14:00:00Z");
  view.status.next_due_utc = parseUtc("2024-05-01T14:10:00Z");
  view.status.light = "key 0.998 pass";
  view.status.disk_free_bytes = 12'000'000'000;
  CameraView up, down;
  up.status = {"cam0", true, ""};
  up.captured = 11;
  up.newest.emplace();
  up.newest->utc = parseUtc("2024-05-01T14:00:02Z");
  down.status = {"cam1", false, "timeout: no picture"};
  down.failed = 3;
  view.cameras = {up, down};
  return view;
}

}  // namespace patina::daemon
