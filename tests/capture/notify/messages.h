// SPDX-License-Identifier: GPL-3.0-or-later
// Messages for the tests of every channel.
#pragma once

#include "capture/notify/message.h"

namespace patina::capture::notify {

inline Message cameraDown() {
  Message m;
  m.kind = MessageKind::kAlert;
  m.about = {"banana box", "banana", "20240501T120000Z-banana"};
  m.utc = parseUtc("2024-05-01T12:07:00Z");
  m.severity = Severity::kCritical;
  m.news.kind = AlertKind::kCameraDown;
  m.news.subject = "cam0";
  m.news.detail = "twin 'cam0': collect: no picture within 12 s";
  m.news.severity = Severity::kCritical;
  m.news.utc = m.utc;
  m.news.since_utc = parseUtc("2024-05-01T12:00:00Z");
  m.news.lasted = std::chrono::minutes(7);
  return m;
}

inline Message over() {
  Message m = cameraDown();
  m.news.event = AlertEvent::kOver;
  return m;
}

inline Message frame() {
  Message m = cameraDown();
  m.kind = MessageKind::kFrame;
  m.severity = Severity::kInfo;
  return m;
}

inline Message run(const std::string& text) {
  Message m = cameraDown();
  m.kind = MessageKind::kRun;
  m.severity = Severity::kInfo;
  m.text = text;
  return m;
}

inline Message test() {
  Message m = cameraDown();
  m.kind = MessageKind::kTest;
  m.severity = Severity::kInfo;
  return m;
}

inline Message status(std::int64_t step) {
  Message m = cameraDown();
  m.kind = MessageKind::kStatus;
  m.severity = Severity::kInfo;
  m.state.step = step;
  m.state.steps = 1008;
  m.state.cameras = {{"cam0", "ok"}};
  m.state.lights = {{"key", "ok"}};
  return m;
}

}  // namespace patina::capture::notify
