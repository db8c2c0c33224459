// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/message.h"

#include <nlohmann/json.hpp>

namespace patina::capture::notify {
namespace {

constexpr std::size_t kSubjectMost = 120;

std::string whatOf(const Message& m) {
  switch (m.kind) {
    case MessageKind::kAlert: {
      std::string what = describe(m.news.kind, m.news.subject);
      if (m.news.event == AlertEvent::kOver) return what + ": over";
      if (m.news.event == AlertEvent::kReminder) return what + ": still";
      return what;
    }
    case MessageKind::kRun:
      return m.text;
    case MessageKind::kTest:
      return "test message";
    case MessageKind::kStatus:
      return "status";
    case MessageKind::kFrame:
      return "frame";
  }
  return "";
}

const char* nameOf(MessageKind kind) {
  static constexpr const char* kNames[] = {"alert", "run", "test", "status", "frame"};
  return kNames[static_cast<int>(kind)];
}

std::string newsText(const AlertNews& n) {
  std::string text = oneLine(n.detail) + "\n";
  if (n.event == AlertEvent::kOver)
    text += "Over after " + formatLasted(n.lasted) + "; it began " + formatUtc(n.since_utc) + ".\n";
  else
    text += "Since " + formatUtc(n.since_utc) + ", " + formatLasted(n.lasted) + " so far.\n";
  if (n.times > 1) text += "It came and went " + std::to_string(n.times) + " times.\n";
  return text;
}

}  // namespace

std::string oneLine(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  return text;
}

bool isForPeople(const Message& message, Severity least) {
  if (message.kind == MessageKind::kTest) return true;
  if (message.severity < least) return false;
  if (message.kind == MessageKind::kRun) return true;
  const AlertNews& n = message.news;
  return message.kind == MessageKind::kAlert &&
         !(n.event == AlertEvent::kOver && n.momentary && n.times == 1);
}

std::string subjectOf(const Message& message) {
  std::string line = std::string("[") + name(message.severity) + "] " + message.about.specimen +
                     ": " + whatOf(message);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ')
      c = ' ';
    else if (static_cast<unsigned char>(c) > '~')
      c = '?';
  if (line.size() > kSubjectMost) line = line.substr(0, kSubjectMost - 3) + "...";
  return line;
}

std::string textOf(const Message& message) {
  const About& about = message.about;
  std::string text = oneLine(whatOf(message)) + "\n";
  if (message.kind == MessageKind::kAlert) text += newsText(message.news);
  if (message.kind == MessageKind::kTest) text += "This channel works.\n";
  if (message.dropped > 0)
    text += std::to_string(message.dropped) +
            " earlier messages could not be delivered and were dropped.\n";
  return text +
         oneLine("Run " + about.run_id + " of " + about.specimen + " on " + about.rig + ", " +
                 formatUtc(message.utc)) +
         "\n";
}

std::string jsonOf(const Message& message) {
  const bool alert = message.kind == MessageKind::kAlert;
  const AlertNews& n = message.news;
  nlohmann::ordered_json json;
  json["schema"] = "patina.alert/1";
  json["kind"] = nameOf(message.kind);
  json["text"] = "[" + std::string(name(message.severity)) + "] " + message.about.specimen + ": " +
                 oneLine(whatOf(message)) + (alert ? " (" + oneLine(n.detail) + ")" : "");
  json["severity"] = name(message.severity);
  json["event"] = alert ? name(n.event) : "";
  json["condition"] = alert ? name(n.kind) : "";
  json["subject"] = alert ? n.subject : "";
  json["detail"] = alert ? oneLine(n.detail) : "";
  json["since_utc_ns"] = alert ? toNs(n.since_utc) : 0;
  json["lasted_ns"] = alert ? n.lasted.count() : 0;
  json["times"] = alert ? n.times : 0;
  json["rig"] = message.about.rig;
  json["specimen"] = message.about.specimen;
  json["run_id"] = message.about.run_id;
  json["utc_ns"] = toNs(message.utc);
  json["dropped"] = message.dropped;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace patina::capture::notify
