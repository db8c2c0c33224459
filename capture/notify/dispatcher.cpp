// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/dispatcher.h"

#include <algorithm>
#include <exception>

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kQueueMost = 100;
constexpr Nanoseconds kMessageAge = 24h, kBeatAge = 1min, kStatusAge = 24h * 366;
constexpr Nanoseconds kFirstRetry = 5s, kLastRetry = 10min;
constexpr Nanoseconds kIdle = 1h;
// A machine that wakes from suspend has not moved for hours: the session gets a moment to do so.
constexpr Nanoseconds kBenefitOfDoubt = 30s;

bool onlyNewestCounts(MessageKind kind) {
  return kind == MessageKind::kStatus || kind == MessageKind::kFrame;
}

Nanoseconds retryAfter(int failures) {
  Nanoseconds wait = kFirstRetry;
  for (int i = 1; i < failures && wait < kLastRetry; ++i) wait *= 2;
  return std::min(wait, kLastRetry);
}

Delivery trySend(Notifier& notifier, const Message& message, const std::stop_token& hurry) {
  try {
    return notifier.send(message, hurry);
  } catch (const std::exception& error) {
    return {Delivery::Result::kTryAgain, error.what()};
  }
}

}  // namespace

Dispatcher::Dispatcher(devices::Clock& clock) : clock_(clock) {}

Dispatcher::~Dispatcher() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
    for (auto& [group, run] : runs_) run.hurry.request_stop();
    wake();
  }
  thread_.join();
}

void Dispatcher::start() {
  thread_ = std::thread([this] { run(); });
}

void Dispatcher::wake() {
  posted_ = true;
  wake_.request_stop();
}

void Dispatcher::run() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      posted_ = false;
    }
    const MonoTime next = work();
    std::stop_source wake;
    {
      const std::lock_guard lock(mutex_);
      if (quit_) return;
      if (posted_) continue;
      wake_ = wake;
    }
    clock_.sleepUntil(next, wake.get_token());
  }
}

Dispatcher::Group Dispatcher::add(std::vector<std::unique_ptr<Notifier>> channels,
                                  const Watch& watch) {
  const std::lock_guard lock(mutex_);
  Run& run = runs_[++last_group_];
  for (auto& notifier : channels) {
    Channel& channel = run.channels.emplace_back();
    channel.report.name = notifier->name();
    channel.notifier = std::move(notifier);
  }
  run.watch = watch;
  run.last_sign = clock_.mono();
  wake();
  return last_group_;
}

void Dispatcher::drop(Channel& channel, std::size_t messages) {
  channel.report.dropped += static_cast<std::int64_t>(messages);
  channel.dropped_untold += static_cast<std::int64_t>(messages);
}

void Dispatcher::enqueue(Channel& channel, const Message& message, MonoTime now) {
  if (!channel.notifier->wants(message)) return;
  if (onlyNewestCounts(message.kind)) {
    const bool beat = message.kind == MessageKind::kFrame;
    // A beat is for the frame that is there now: it is never sent later, when frames may have
    // stopped.
    if (beat && now < channel.newest_not_before) return;
    channel.newest = Queued{message, now + (beat ? kBeatAge : kStatusAge)};
    return;
  }
  if (channel.queue.size() >= kQueueMost) {
    channel.queue.pop_front();
    drop(channel, 1);
  }
  channel.queue.push_back({message, now + kMessageAge});
}

void Dispatcher::post(Group group, const Message& message) {
  const std::lock_guard lock(mutex_);
  const auto found = runs_.find(group);
  if (found == runs_.end() || found->second.closing) return;
  const MonoTime now = clock_.mono();
  sign(found->second, now);
  for (Channel& channel : found->second.channels) enqueue(channel, message, now);
  wake();
}

void Dispatcher::alive(Group group) {
  const std::lock_guard lock(mutex_);
  if (const auto found = runs_.find(group); found != runs_.end())
    sign(found->second, clock_.mono());
}

void Dispatcher::sign(Run& run, MonoTime now) {
  run.last_sign = now;
  run.suspected.reset();
  if (!run.stalled) return;
  run.stalled = false;
  tellStall(run, AlertEvent::kOver, now);
  wake();
}

void Dispatcher::tellStall(Run& run, AlertEvent event, MonoTime now) {
  Message message;
  message.kind = MessageKind::kAlert;
  message.about = run.watch.about;
  message.utc = clock_.utc();
  message.severity = run.watch.severity;
  message.news.event = event;
  message.news.kind = AlertKind::kStalled;
  message.news.severity = run.watch.severity;
  message.news.utc = message.utc;
  message.news.lasted = now - run.last_sign;
  message.news.since_utc = message.utc - message.news.lasted;
  message.news.detail = event == AlertEvent::kOver
                            ? "the session moves again"
                            : "the session gives no sign of life: restart it; nothing that was "
                              "acknowledged is lost";
  for (Channel& channel : run.channels) enqueue(channel, message, now);
}

void Dispatcher::lookForStall(Run& run, MonoTime now) {
  if (run.watch.after <= 0ns || run.stalled || run.closing) return;
  if (now - run.last_sign < run.watch.after) return;
  if (!run.suspected) run.suspected = now;
  if (now - *run.suspected < kBenefitOfDoubt) return;
  run.stalled = true;
  tellStall(run, AlertEvent::kBegins, now);
}

void Dispatcher::look(MonoTime now) {
  for (auto& [group, run] : runs_) {
    lookForStall(run, now);
    for (Channel& channel : run.channels) {
      while (!channel.queue.empty() && channel.queue.front().expires <= now) {
        channel.queue.pop_front();
        drop(channel, 1);
      }
      if (channel.newest && channel.newest->expires <= now) channel.newest.reset();
    }
  }
}

// Messages before states: a state waits for no one.
std::optional<Dispatcher::Sending> Dispatcher::takeDueOf(Run& run, Channel& channel, MonoTime now) {
  if (!run.closing && now < channel.not_before) return std::nullopt;
  Sending sending{&run, &channel, {}, false};
  if (!channel.queue.empty()) {
    sending.queued = std::move(channel.queue.front());
    channel.queue.pop_front();
    sending.queued.message.dropped = channel.dropped_untold;
    return sending;
  }
  if (!channel.newest || (!run.closing && now < channel.newest_not_before)) return std::nullopt;
  sending.queued = std::move(*channel.newest);
  sending.newest = true;
  channel.newest.reset();
  return sending;
}

std::optional<Dispatcher::Sending> Dispatcher::takeDue(MonoTime now) {
  std::vector<std::pair<Run*, Channel*>> all;
  for (auto& [group, run] : runs_)
    for (Channel& channel : run.channels) all.emplace_back(&run, &channel);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [run, channel] = all[(turn_ + i) % all.size()];
    if (auto due = takeDueOf(*run, *channel, now)) {
      turn_ = (turn_ + i + 1) % all.size();
      return due;
    }
  }
  return std::nullopt;
}

void Dispatcher::finish(Sending sending, const Delivery& delivery) {
  Channel& channel = *sending.channel;
  const MonoTime now = clock_.mono();
  if (delivery.delivered()) {
    ++channel.report.delivered;
    channel.report.last_success_utc = clock_.utc();
    channel.failures = 0;
    channel.not_before = now;
    if (sending.newest) channel.newest_not_before = now + channel.notifier->pause();
    channel.dropped_untold -= sending.queued.message.dropped;
    return;
  }
  channel.report.last_error = delivery.answer;
  channel.report.last_error_utc = clock_.utc();
  channel.not_before = now + retryAfter(++channel.failures);
  if (delivery.result == Delivery::Result::kRefused || sending.run->closing) {
    if (!sending.newest) drop(channel, 1);
    if (!sending.run->closing) return;
    // At the end a channel gets one failure, not one a message.
    drop(channel, channel.queue.size());
    channel.queue.clear();
    channel.newest.reset();
  } else if (sending.newest) {
    if (!channel.newest) channel.newest = std::move(sending.queued);
  } else if (channel.queue.size() < kQueueMost) {
    channel.queue.push_front(std::move(sending.queued));
  } else {
    drop(channel, 1);
  }
}

bool Dispatcher::sendOne() {
  std::optional<Sending> sending;
  {
    const std::lock_guard lock(mutex_);
    if (quit_) return false;
    const MonoTime now = clock_.mono();
    look(now);
    sending = takeDue(now);
    if (!sending) return false;
  }
  const Delivery delivery = trySend(*sending->channel->notifier, sending->queued.message,
                                    sending->run->hurry.get_token());
  const std::lock_guard lock(mutex_);
  finish(std::move(*sending), delivery);
  return true;
}

// Runs that have said their last: their channels close outside of the lock, which may take a
// second.
void Dispatcher::closeFinished() {
  std::vector<std::unique_ptr<Notifier>> closing;
  std::vector<std::stop_source> closed;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [group, run] : runs_) {
      if (!run.closing) continue;
      for (Channel& channel : run.channels)
        if (channel.notifier) closing.push_back(std::move(channel.notifier));
      closed.push_back(run.closed);
    }
  }
  closing.clear();
  for (std::stop_source& source : closed) source.request_stop();
}

MonoTime Dispatcher::work() {
  while (sendOne()) continue;
  closeFinished();
  const std::lock_guard lock(mutex_);
  return nextTime(clock_.mono());
}

MonoTime Dispatcher::nextTime(MonoTime now) const {
  MonoTime next = now + kIdle;
  for (const auto& [group, run] : runs_) {
    if (run.closing) continue;
    if (run.watch.after > 0ns && !run.stalled)
      next = std::min(
          next, run.suspected ? *run.suspected + kBenefitOfDoubt : run.last_sign + run.watch.after);
    for (const Channel& channel : run.channels) {
      if (!channel.queue.empty()) next = std::min(next, channel.not_before);
      if (channel.newest)
        next = std::min(next, std::max(channel.not_before, channel.newest_not_before));
    }
  }
  return std::max(next, now);
}

std::vector<ChannelReport> Dispatcher::reportsOf(const Run& run) {
  std::vector<ChannelReport> reports;
  for (const Channel& channel : run.channels) {
    reports.push_back(channel.report);
    reports.back().queued = channel.queue.size();
  }
  return reports;
}

std::vector<ChannelReport> Dispatcher::reports(Group group) const {
  const std::lock_guard lock(mutex_);
  const auto found = runs_.find(group);
  return found == runs_.end() ? std::vector<ChannelReport>() : reportsOf(found->second);
}

std::vector<ChannelReport> Dispatcher::remove(Group group, Nanoseconds within) {
  std::stop_source hurry, closed;
  {
    const std::lock_guard lock(mutex_);
    const auto found = runs_.find(group);
    if (found == runs_.end()) return {};
    Run& run = found->second;
    run.closing = true;
    for (Channel& channel : run.channels)
      if (channel.newest && channel.newest->message.kind == MessageKind::kFrame)
        channel.newest.reset();
    hurry = run.hurry;
    closed = run.closed;
    wake();
  }
  if (thread_.joinable()) {
    if (clock_.sleepUntil(clock_.mono() + within, closed.get_token()) == devices::Wake::kDue)
      hurry.request_stop();
    while (!closed.stop_requested()) clock_.sleepUntil(clock_.mono() + kIdle, closed.get_token());
  } else {
    work();
  }
  const std::lock_guard lock(mutex_);
  auto node = runs_.extract(group);
  return reportsOf(node.mapped());
}

}  // namespace patina::capture::notify
