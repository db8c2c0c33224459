// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/event_broker.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace patina::http {

class EventBroker::Stream {
 public:
  std::string peer;
  std::function<void()> wake, drop;
  std::uint64_t next = 0;                   // the number of the event it takes next
  std::shared_ptr<const std::string> text;  // what it is in the middle of
  std::size_t sent = 0;                     // bytes of text
  bool reset_due = false, beat_due = false, resting = false, over = false;
};

EventBroker::EventBroker(BrokerLimits limits, std::string epoch)
    : limits_(limits), epoch_(std::move(epoch)), thread_([this] { run(); }) {}

EventBroker::~EventBroker() {
  stop();
  thread_.join();
}

void EventBroker::publish(std::string name, std::string data) {
  const std::lock_guard lock(inbox_mutex_);
  if (closing_) return;
  if (inbox_.size() >= limits_.inbox_events || name.size() + data.size() > limits_.event_bytes) {
    ++dropped_events_;
    return;
  }
  inbox_.push_back({{}, std::move(name), std::move(data)});
  inbox_filled_.notify_one();
}

void EventBroker::run() {
  for (;;) {
    std::deque<Event> events;
    {
      std::unique_lock lock(inbox_mutex_);
      inbox_filled_.wait(lock, [this] { return closing_ || !inbox_.empty(); });
      if (inbox_.empty()) return;
      events.swap(inbox_);
    }
    const std::lock_guard lock(mutex_);
    for (Event& event : events) append(event);
    for (const auto& stream : streams_) {
      if (stream->next < firstNumber()) dropLocked(*stream);
      wakeLocked(*stream);
    }
  }
}

void EventBroker::append(const Event& event) {
  const std::uint64_t number = next_++;
  auto text = std::make_shared<const std::string>(
      eventText({eventId(epoch_, number), event.name, event.data}));
  ring_bytes_ += text->size();
  ring_.push_back({number, std::move(text)});
  while (ring_.size() > limits_.ring_events || ring_bytes_ > limits_.ring_bytes) {
    ring_bytes_ -= ring_.front().text->size();
    ring_.pop_front();
  }
}

void EventBroker::wakeLocked(Stream& stream) {
  if (!stream.resting) return;
  stream.resting = false;
  stream.wake();
}

void EventBroker::dropLocked(Stream& stream) {
  if (stream.over) return;
  stream.over = true;
  ++dropped_streams_;
  stream.drop();
}

std::shared_ptr<EventBroker::Stream> EventBroker::open(const std::string& peer,
                                                       const std::string& last_event_id,
                                                       std::function<void()> wake,
                                                       std::function<void()> drop) {
  const std::lock_guard lock(mutex_);
  const auto of_peer = std::count_if(streams_.begin(), streams_.end(),
                                     [&](const auto& stream) { return stream->peer == peer; });
  if (stopped_ || streams_.size() >= limits_.streams ||
      static_cast<std::size_t>(of_peer) >= limits_.streams_a_peer)
    return nullptr;
  auto stream = std::make_shared<Stream>();
  stream->peer = peer;
  stream->wake = std::move(wake);
  stream->drop = std::move(drop);
  stream->beat_due = true;  // bytes at once, so that the reader knows that it is heard
  stream->next = next_;
  if (const auto last = eventNumber(last_event_id, epoch_);
      last && *last + 1 >= firstNumber() && *last < next_) {
    stream->next = *last + 1;
  } else {
    stream->reset_due = !last_event_id.empty();
  }
  streams_.push_back(stream);
  return stream;
}

std::shared_ptr<const std::string> EventBroker::nextText(Stream& stream) const {
  if (std::exchange(stream.beat_due, false)) return std::make_shared<const std::string>(":\n\n");
  if (std::exchange(stream.reset_due, false))
    return std::make_shared<const std::string>(
        eventText({eventId(epoch_, stream.next - 1), "reset", "{}"}));
  if (stream.next >= next_) return nullptr;
  return ring_[stream.next++ - firstNumber()].text;
}

long EventBroker::read(Stream& stream, std::span<char> bytes, const std::function<void()>& rest) {
  const std::lock_guard lock(mutex_);
  if (stream.over || stopped_) return -1;
  if (!stream.text || stream.sent == stream.text->size()) {
    stream.text = nextText(stream);
    stream.sent = 0;
  }
  if (!stream.text) {
    stream.resting = true;
    rest();
    return 0;
  }
  const std::size_t n = std::min(bytes.size(), stream.text->size() - stream.sent);
  std::memcpy(bytes.data(), stream.text->data() + stream.sent, n);
  stream.sent += n;
  return static_cast<long>(n);
}

void EventBroker::close(const std::shared_ptr<Stream>& stream) {
  const std::lock_guard lock(mutex_);
  streams_.remove(stream);
}

void EventBroker::beat() {
  const std::lock_guard lock(mutex_);
  for (const auto& stream : streams_) {
    if (stream->beat_due) dropLocked(*stream);
    stream->beat_due = true;
    wakeLocked(*stream);
  }
}

void EventBroker::nudge() {
  const std::lock_guard lock(mutex_);
  for (const auto& stream : streams_) {
    if (!stream->resting) continue;
    stream->beat_due = true;
    wakeLocked(*stream);
  }
}

void EventBroker::stop() {
  {
    const std::lock_guard lock(inbox_mutex_);
    closing_ = true;
    inbox_filled_.notify_one();
  }
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  for (const auto& stream : streams_) wakeLocked(*stream);
}

EventBroker::Counts EventBroker::counts() const {
  Counts counts{};
  {
    const std::lock_guard lock(inbox_mutex_);
    counts.dropped_events = dropped_events_;
  }
  const std::lock_guard lock(mutex_);
  counts.published = next_ - 1;
  counts.dropped_streams = dropped_streams_;
  counts.streams = streams_.size();
  return counts;
}

}  // namespace patina::http
