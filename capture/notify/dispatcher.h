// SPDX-License-Identifier: GPL-3.0-or-later
// Brings messages to channels on a thread of its own. Who posts never waits for a channel: queues
// are bounded, what does not fit is dropped, counted, and told with the next message that arrives.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "capture/notify/notifier.h"
#include "devices/clock.h"

namespace patina::capture::notify {

struct ChannelReport {
  std::string name;
  std::int64_t delivered = 0, dropped = 0;  // dropped: no room, too old, refused, or at the end
  std::size_t queued = 0;
  std::optional<UtcTime> last_success_utc, last_error_utc;
  std::string last_error;  // without secrets
};

// When a run that gives no sign of life is told as stalled.
struct Watch {
  Nanoseconds after{};  // 0: never
  Severity severity = Severity::kCritical;
  About about;
};

// One a process. Thread-safe. A group is the channels of one run.
class Dispatcher {
 public:
  using Group = int;
  explicit Dispatcher(devices::Clock& clock);
  ~Dispatcher();  // drops what is left
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  // Begins the thread; the clock must be thread-safe. Without it, on a virtual clock, nothing
  // happens but in work() and remove().
  void start();
  // Sends what is due. When to come again; the far future when nothing waits.
  MonoTime work();

  Group add(std::vector<std::unique_ptr<Notifier>> channels, const Watch& watch);
  void post(Group group, const Message& message);
  void alive(Group group);  // a sign of life; post() is one too
  // Tries once more what is queued, for at most about `within`, and closes the channels. Answers
  // with their last reports.
  std::vector<ChannelReport> remove(Group group, Nanoseconds within);
  std::vector<ChannelReport> reports(Group group) const;

 private:
  struct Queued {
    Message message;
    MonoTime expires;
  };
  struct Channel {
    std::unique_ptr<Notifier> notifier;
    std::deque<Queued> queue;
    std::optional<Queued> newest;  // of the kinds of which only the newest counts
    MonoTime newest_not_before;    // its pause
    MonoTime not_before;           // after a failure
    int failures = 0;              // in a row
    std::int64_t dropped_untold = 0;
    ChannelReport report;
  };
  struct Run {
    std::vector<Channel> channels;
    Watch watch;
    MonoTime last_sign;
    std::optional<MonoTime> suspected;  // since when it seems stalled
    bool stalled = false, closing = false;
    std::stop_source hurry, closed;
  };
  struct Sending {  // taken out of its channel while it is sent
    Run* run = nullptr;
    Channel* channel = nullptr;
    Queued queued;
    bool newest = false;
  };

  void run();
  bool sendOne();
  std::optional<Sending> takeDue(MonoTime now);
  static std::optional<Sending> takeDueOf(Run& run, Channel& channel, MonoTime now);
  void finish(Sending sending, const Delivery& delivery);
  static void enqueue(Channel& channel, const Message& message, MonoTime now);
  static void drop(Channel& channel, std::size_t messages);
  void look(MonoTime now);
  void lookForStall(Run& run, MonoTime now);
  void tellStall(Run& run, AlertEvent event, MonoTime now);
  void sign(Run& run, MonoTime now);
  void closeFinished();
  MonoTime nextTime(MonoTime now) const;
  void wake();
  static std::vector<ChannelReport> reportsOf(const Run& run);

  devices::Clock& clock_;
  mutable std::mutex mutex_;  // guards all below; never held while a channel sends or closes
  std::map<Group, Run> runs_;
  Group last_group_ = 0;
  std::size_t turn_ = 0;  // so that no channel starves
  bool quit_ = false, posted_ = false;
  std::stop_source wake_;
  std::thread thread_;
};

}  // namespace patina::capture::notify
