// SPDX-License-Identifier: GPL-3.0-or-later
// What is told, and its forms: a line, a text, JSON with a fixed schema. Values in, text out.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "capture/alerts.h"

namespace patina::capture::notify {

// Whose message it is; the same for a whole run.
struct About {
  std::string rig, specimen, run_id;
};

// What the rig is at, for those who show it. A newer one takes the place of an older one.
struct RunState {
  std::string state = "running";  // then what a session ends with: "finished" "stopped" ...
  std::int64_t step = 0, steps = 0, captured = 0, held = 0, skipped = 0, missed = 0, failed = 0;
  std::uint64_t disk_free_bytes = 0;
  UtcTime next_due_utc;
  std::map<std::string, std::string> cameras;  // id -> "ok" "down"
  std::map<std::string, std::string> lights;   // id -> "ok" "drifting" "held" "dead"
};

enum class MessageKind {
  kAlert,   // news of a condition
  kRun,     // a run began, went on, ended: `text` says so
  kTest,    // "does this channel work?"
  kStatus,  // `state`; only the newest counts
  kFrame    // a frame was acknowledged; only the newest counts
};

struct Message {
  MessageKind kind = MessageKind::kTest;
  About about;
  UtcTime utc;
  Severity severity = Severity::kInfo;
  AlertNews news;            // of kAlert
  std::string text;          // of kRun
  RunState state;            // of kStatus
  std::int64_t dropped = 0;  // messages lost on this channel since the last that arrived
};

// Whether a person who asked for what is at least so bad should read it: alerts, runs, every test;
// not the end of a single moment.
bool isForPeople(const Message& message, Severity least);

// "[critical] banana: camera cam0 down": printable ASCII, at most 120 characters.
std::string subjectOf(const Message& message);
// Lines for a person, UTF-8 without control characters; the first says what it is about.
std::string textOf(const Message& message);
// {"schema":"patina.alert/1", ...}: README.md lists the keys; all are always there.
std::string jsonOf(const Message& message);

// Without control characters (each becomes a space), invalid UTF-8 left to the JSON writer.
std::string oneLine(std::string text);

}  // namespace patina::capture::notify
