// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/heartbeat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/notify/dispatcher.h"
#include "tests/capture/notify/messages.h"
#include "tests/capture/notify/receiver.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using patina::testing::Receiver;

class Beats : public ::testing::Test {
 protected:
  Beats() {
    HeartbeatSettings settings;
    settings.url = receiver.url("/beat");
    std::vector<std::unique_ptr<Notifier>> channels;
    channels.push_back(std::make_unique<Heartbeat>(settings));
    group = dispatcher.add(std::move(channels), {});
  }
  std::size_t beats() const { return receiver.requests().size(); }

  Receiver receiver;
  devices::VirtualClock clock{parseUtc("2024-05-01")};
  Dispatcher dispatcher{clock};
  Dispatcher::Group group = 0;
};

TEST_F(Beats, AreGetsAfterFramesAndNothingElse) {
  dispatcher.post(group, cameraDown());
  dispatcher.post(group, status(1));
  dispatcher.work();
  EXPECT_EQ(beats(), 0u);
  dispatcher.post(group, frame());
  dispatcher.work();
  EXPECT_EQ(receiver.requests().at(0).line, "GET /beat HTTP/1.1");
}

TEST_F(Beats, ComeAtMostOnceAMinute) {
  for (int second = 0; second < 180; second += 5) {
    dispatcher.post(group, frame());
    dispatcher.work();
    clock.advance(5s);
  }
  EXPECT_EQ(beats(), 3u);
}

TEST_F(Beats, StopWhenFramesStop) {
  for (int second = 0; second <= 90; second += 30) {
    dispatcher.post(group, frame());
    dispatcher.work();
    clock.advance(30s);
  }
  const std::size_t before = beats();
  for (int minute = 0; minute < 600; ++minute) {
    clock.advance(1min);
    dispatcher.work();
  }
  EXPECT_EQ(beats(), before);
}

TEST_F(Beats, AreTriedAgainForAMinuteAndThenLetGo) {
  receiver.answerWith(Receiver::status(503));
  dispatcher.post(group, frame());
  for (int second = 0; second < 3600; second += 5) {
    dispatcher.work();
    clock.advance(5s);
  }
  EXPECT_EQ(beats(), 4u);  // at once, after 5, 15 and 35 s
  receiver.answerWith(Receiver::status(200));
  dispatcher.work();
  EXPECT_EQ(beats(), 4u);
}

}  // namespace
}  // namespace patina::capture::notify
