// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/event_broker.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <vector>

namespace patina::http {
namespace {

// Reads as a server's thread does: rests when there is nothing, and waits to be woken.
class Reader {
 public:
  Reader(EventBroker& broker, const std::string& last_event_id = {}, const std::string& peer = "p")
      : broker_(broker), parser_([this](const Event& event) { events.push_back(event); }) {
    stream_ = broker.open(
        peer, last_event_id, [this] { wakes_.release(); }, [this] { dropped = true; });
  }
  ~Reader() {
    if (stream_) broker_.close(stream_);
  }
  explicit operator bool() const { return stream_ != nullptr; }

  // False when the stream is over.
  bool readUntil(std::size_t count) {
    std::array<char, 100> bytes{};
    while (events.size() < count) {
      const long n = broker_.read(*stream_, bytes, [] {});
      if (n < 0) return false;
      if (n == 0) wakes_.acquire();
      parser_.feed({bytes.data(), static_cast<std::size_t>(n)});
    }
    return true;
  }
  // All there is; the number of bytes.
  long drain() {
    std::array<char, 4096> bytes{};
    long all = 0;
    for (long n = 0; (n = broker_.read(*stream_, bytes, [] {})) > 0; all += n)
      parser_.feed({bytes.data(), static_cast<std::size_t>(n)});
    return all;
  }

  std::vector<Event> events;
  std::atomic<bool> dropped{false};

 private:
  struct Semaphore {
    void release() {
      const std::lock_guard lock(mutex);
      ++count;
      more.notify_one();
    }
    void acquire() {
      std::unique_lock lock(mutex);
      more.wait(lock, [this] { return count > 0; });
      --count;
    }
    std::mutex mutex;
    std::condition_variable more;
    int count = 0;
  };
  EventBroker& broker_;
  EventParser parser_;
  Semaphore wakes_;
  std::shared_ptr<EventBroker::Stream> stream_;
};

TEST(EventBroker, GivesEveryReaderEveryEventInOrder) {
  EventBroker broker({}, "e");
  Reader one(broker), two(broker);
  for (int i = 0; i < 100; ++i) broker.publish("step", std::to_string(i));
  ASSERT_TRUE(one.readUntil(100));
  ASSERT_TRUE(two.readUntil(100));
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(one.events[static_cast<std::size_t>(i)].data, std::to_string(i));
    EXPECT_EQ(two.events[static_cast<std::size_t>(i)].id, "e-" + std::to_string(i + 1));
  }
}

TEST(EventBroker, GoesOnAfterTheLastEventAReaderHas) {
  EventBroker broker({}, "e");
  Reader first(broker);
  for (int i = 1; i <= 5; ++i) broker.publish("step", std::to_string(i));
  ASSERT_TRUE(first.readUntil(5));
  Reader again(broker, "e-3");
  ASSERT_TRUE(again.readUntil(2));
  EXPECT_EQ(again.events[0].data, "4");
  EXPECT_EQ(again.events[1].data, "5");
}

TEST(EventBroker, TellsAReaderWhoseEventsAreGoneToStartAgain) {
  BrokerLimits limits;
  limits.ring_events = 4;
  EventBroker broker(limits, "e");
  Reader first(broker);
  for (int i = 1; i <= 10; ++i) {  // one by one, so that the reader keeps up
    broker.publish("step", std::to_string(i));
    ASSERT_TRUE(first.readUntil(static_cast<std::size_t>(i)));
  }
  for (const char* id : {"e-3", "old-9", "nonsense", "e-11"}) {
    Reader late(broker, id);
    ASSERT_TRUE(late.readUntil(1));
    EXPECT_EQ(late.events[0].name, "reset") << id;
    EXPECT_EQ(late.events[0].id, "e-10");
  }
}

TEST(EventBroker, DropsAndCountsAReaderThatTheRingHasOvertaken) {
  BrokerLimits limits;
  limits.ring_events = 4;
  EventBroker broker(limits, "e");
  Reader slow(broker), quick(broker);
  ASSERT_EQ(slow.drain() > 0, true);
  for (int i = 1; i <= 6; ++i) {
    broker.publish("step", std::to_string(i));
    ASSERT_TRUE(quick.readUntil(static_cast<std::size_t>(i)));
  }
  EXPECT_TRUE(slow.dropped);
  EXPECT_FALSE(slow.readUntil(1));
  EXPECT_FALSE(quick.dropped);
  EXPECT_EQ(broker.counts().dropped_streams, 1u);
}

TEST(EventBroker, KeepsItsRingInBoundsOfBytesToo) {
  BrokerLimits limits;
  limits.ring_bytes = 1000;
  EventBroker broker(limits, "e");
  Reader quick(broker);
  for (int i = 1; i <= 10; ++i) {
    broker.publish("step", std::string(300, 'x'));
    ASSERT_TRUE(quick.readUntil(static_cast<std::size_t>(i)));
  }
  Reader late(broker, "e-5");  // of which three events are left at most
  ASSERT_TRUE(late.readUntil(1));
  EXPECT_EQ(late.events[0].name, "reset");
}

TEST(EventBroker, DropsAnEventThatIsTooLargeAndCountsIt) {
  EventBroker broker({}, "e");
  Reader reader(broker);
  broker.publish("step", std::string(65 << 10, 'x'));
  broker.publish("step", "small");
  ASSERT_TRUE(reader.readUntil(1));
  EXPECT_EQ(reader.events[0].data, "small");
  EXPECT_EQ(broker.counts().dropped_events, 1u);
}

TEST(EventBroker, HasSixteenStreamsAndEightForOnePeer) {
  EventBroker broker({}, "e");
  std::vector<std::unique_ptr<Reader>> readers;
  const auto open = [&](const std::string& peer) {
    readers.push_back(std::make_unique<Reader>(broker, "", peer));
    return static_cast<bool>(*readers.back());
  };
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(open("a"));
  EXPECT_FALSE(open("a"));
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(open("b"));
  EXPECT_FALSE(open("c"));
  readers.erase(readers.begin());
  EXPECT_TRUE(open("c"));
}

TEST(EventBroker, DropsAReaderThatHasNotTakenTheLastBeat) {
  EventBroker broker({}, "e");
  Reader alive(broker), dead(broker);
  alive.drain();
  broker.beat();  // the first greeting of `dead` is still there
  EXPECT_TRUE(dead.dropped);
  EXPECT_FALSE(alive.dropped);
  EXPECT_GT(alive.drain(), 0);
}

TEST(EventBroker, EndsEveryStreamWhenItStops) {
  EventBroker broker({}, "e");
  Reader reader(broker);
  reader.drain();
  broker.stop();
  EXPECT_FALSE(reader.readUntil(1));
  EXPECT_FALSE(Reader(broker));
  broker.publish("step", "late");
}

}  // namespace
}  // namespace patina::http
