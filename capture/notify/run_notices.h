// SPDX-License-Identifier: GPL-3.0-or-later
// What is told of one run: its alerts, its beginning and end, its state, its heartbeat.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "capture/notify/channels.h"
#include "capture/notify/dispatcher.h"
#include "capture/session.h"

namespace patina::capture::notify {

// Made before the session, and gone before the dispatcher. The hooks are called on the session's
// thread and never wait; all else is for the thread that made it.
class RunNotices {
 public:
  // Tells that the run begins or goes on.
  RunNotices(Dispatcher& dispatcher, const devices::Clock& clock, const Plan& plan,
             const devices::RigSpec& rig, const RunStart& start,
             std::vector<std::unique_ptr<Notifier>> channels);
  ~RunNotices();  // closes the channels: at most about five seconds
  RunNotices(const RunNotices&) = delete;
  RunNotices& operator=(const RunNotices&) = delete;

  // Adds itself to what the hooks do already.
  void hookInto(SessionHooks& hooks);
  void ended(const SessionSummary& summary);
  // What others than the session found, as a scrub that met a damaged file: told every time it is
  // called. From any thread.
  void occurred(AlertKind kind, const std::string& subject, const std::string& detail);
  // An exception ended the session.
  void failed(const Failure& failure);
  // After it the run is told no more. What became of each channel.
  std::vector<ChannelReport> close();
  std::vector<ChannelReport> reports() const { return dispatcher_.reports(group_); }

 private:
  Message message(MessageKind kind, Severity severity) const;
  Message messageOf(const AlertNews& news) const;
  void say(Severity severity, const std::string& text);
  void tell(const AlertNews& news);
  void show(const SessionStatus& status, const std::string& state);
  void showDevices();

  Dispatcher& dispatcher_;
  const devices::Clock& clock_;
  About about_;
  AlertRules rules_;
  Inventory inventory_;
  RunState state_;
  std::set<std::pair<AlertKind, std::string>> on_;  // told and not over, with their subjects
  Dispatcher::Group group_ = 0;
};

About aboutOf(const Plan& plan, const devices::RigSpec& rig, const std::string& run_id);
Inventory inventoryOf(const devices::RigSpec& rig);

}  // namespace patina::capture::notify
