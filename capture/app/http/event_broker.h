// SPDX-License-Identifier: GPL-3.0-or-later
// Hands events to the streams that listen. A ring of the last events is all it keeps: a stream is
// only a place in it, so a slow reader costs no memory, and one that the ring has overtaken is
// dropped and counted.
//
// Threads: publish() from anywhere; it moves two strings into an inbox and never waits for a
// stream. A thread of the broker's own fans out. The rest is called by the server's threads.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>

#include "capture/app/http/event_wire.h"

namespace patina::http {

struct BrokerLimits {
  std::size_t streams = 16, streams_a_peer = 8;
  std::size_t ring_events = 1024, ring_bytes = 1 << 20;
  std::size_t inbox_events = 1024, event_bytes = 64 << 10;
};

class EventBroker {
 public:
  explicit EventBroker(BrokerLimits limits, std::string epoch);
  ~EventBroker();  // after stop()

  // Over 64 KiB, or faster than the inbox is emptied: dropped and counted.
  void publish(std::string name, std::string data);

  class Stream;
  // Begins after `last_event_id` when the ring still has what follows, else with an event "reset"
  // that tells the reader to ask for the whole state, and goes on with what is new. An empty id
  // begins with what is new. `wake` and `drop` are called under a lock and must not call back or
  // block: wake after read() gave nothing, drop when the stream is too slow. Null when all streams,
  // or all of this peer's, are taken.
  std::shared_ptr<Stream> open(const std::string& peer, const std::string& last_event_id,
                               std::function<void()> wake, std::function<void()> drop);
  // The next bytes; 0: none yet, and `rest` was called, under the lock, before any wake; -1: it is
  // over.
  long read(Stream& stream, std::span<char> bytes, const std::function<void()>& rest);
  void close(const std::shared_ptr<Stream>& stream);

  // A comment for everyone, so that a dead peer is found; whoever has not taken the last one is
  // dropped.
  void beat();
  // The same for those only that have taken all there was.
  void nudge();
  // All streams end; open() gives null from now on.
  void stop();

  struct Counts {
    std::uint64_t published, dropped_events, dropped_streams;
    std::size_t streams;
  };
  Counts counts() const;

 private:
  struct Entry {
    std::uint64_t number;
    std::shared_ptr<const std::string> text;
  };
  void run();
  void append(const Event& event);
  void dropLocked(Stream& stream);
  void wakeLocked(Stream& stream);
  std::shared_ptr<const std::string> nextText(Stream& stream) const;
  std::uint64_t firstNumber() const { return ring_.empty() ? next_ : ring_.front().number; }

  const BrokerLimits limits_;
  const std::string epoch_;

  mutable std::mutex inbox_mutex_;
  std::condition_variable inbox_filled_;
  std::deque<Event> inbox_;
  bool closing_ = false;
  std::uint64_t dropped_events_ = 0;

  mutable std::mutex mutex_;  // never taken before inbox_mutex_ is let go
  std::deque<Entry> ring_;
  std::size_t ring_bytes_ = 0;
  std::uint64_t next_ = 1, dropped_streams_ = 0;
  std::list<std::shared_ptr<Stream>> streams_;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace patina::http
