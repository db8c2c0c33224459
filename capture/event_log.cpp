// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/event_log.h"

#include <cstdio>

namespace patina::capture {

void EventLog::line(const std::string& text) {
  hash_.add(std::as_bytes(std::span(text.data(), text.size())));
}

void EventLog::step(const db::StepRow& s) {
  line("step " + (s.number ? std::to_string(*s.number) : std::string("manual")) + " " +
       db::name(s.decision) + " " + std::to_string(s.shots_captured) + "/" +
       std::to_string(s.shots_due) + " " + std::to_string(s.retries) + "\n");
}

void EventLog::frame(const db::ShotRow& shot, const db::FrameRow& frame) {
  line("frame " + shot.device_id + " " + shot.light_state + " " +
       std::to_string(shot.exposure_index) + " " + std::to_string(shot.attempt) + " ");
  hash_.add(std::as_bytes(std::span(frame.sha256.bytes)));
}

void EventLog::checks(std::span<const db::LightCheckRow> rows) {
  char text[160];
  for (const db::LightCheckRow& r : rows) {
    // Hexadecimal floating point: every bit of the level counts.
    const int n = std::snprintf(text, sizeof text, "light %s %d %s %s %a %s\n",
                                r.light_state.c_str(), r.exposure_index, r.source.c_str(),
                                r.channel.c_str(), r.level, r.verdict.c_str());
    line(std::string(text, static_cast<std::size_t>(n < 160 ? n : 159)));
  }
}

std::string EventLog::finish() { return hash_.finish().hex(); }

}  // namespace patina::capture
