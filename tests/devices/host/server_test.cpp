// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <thread>

#include "processing/image/failure.h"
#include "tests/contract/stub_devices.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

// A server on a thread of its own, and what it answers to a first message.
Answer answerTo(const Bytes& message, const DeviceMaker& make, const DeviceFinder& find = {}) {
  const RealClock clock;
  auto ends = makeChannelEnds();
  Channel ours(std::move(ends->ours)), theirs(std::move(ends->theirs));
  std::jthread server([&] { serve(theirs, make, find); });
  EXPECT_TRUE(ours.send(message, clock.mono() + 10s));
  const auto answer = ours.receive(clock.mono() + 10s);
  shutdown(ours.fd(), SHUT_RDWR);
  return *decodeAnswer(*answer);
}

std::string errorOf(const Answer& answer) {
  EXPECT_EQ(answer.kind, AnswerKind::kFailed);
  Error error;
  Reader from(answer.body);
  get(from, error);
  return error.what;
}

Rig oneLamp(const Hello&, Clock&) {
  Rig rig;
  rig.lights.push_back(patina::testing::makeStubLight("key"));
  return rig;
}

TEST(Server, SaysWhatItCannotServe) {
  Hello hello;
  hello.devices = {"fill"};
  EXPECT_THAT(errorOf(answerTo(encode(hello), oneLamp)), HasSubstr("no device 'fill'"));
  EXPECT_THAT(errorOf(answerTo(encode(hello),
                               [](const Hello&, Clock&) -> Rig {
                                 throw Failure(Exit::kConfig, "rig.toml:3: no such key");
                               })),
              HasSubstr("rig.toml:3"));
}

TEST(Server, ServesTheDevicesOfTheHello) {
  Hello hello;
  hello.devices = {"key"};
  EXPECT_EQ(answerTo(encode(hello), oneLamp).kind, AnswerKind::kDone);
}

TEST(Server, LooksForWhatIsAttached) {
  Hello hello;
  hello.find = "gphoto2";
  const Answer answer = answerTo(encode(hello), oneLamp, [](const std::string& backend) {
    FoundDevice device;
    device.model = "D800";
    device.facts = {{"asked", backend}};
    device.choices = {{"iso", {"100", "200"}}};
    device.troubles = {{true, "its battery is low", "charge it"}};
    return std::vector<FoundDevice>{device};
  });
  std::vector<FoundDevice> found;
  Reader from(answer.body);
  get(from, found);
  ASSERT_TRUE(from.whole());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].facts[0].second, "gphoto2");
  EXPECT_EQ(found[0].choices[0].second[1], "200");
  EXPECT_EQ(found[0].troubles[0].do_this, "charge it");
  EXPECT_TRUE(found[0].troubles[0].fatal);
}

TEST(Server, NonsenseForAGreetingIsRefused) {
  EXPECT_THAT(errorOf(answerTo(Bytes(20, std::byte{9}), oneLamp)), HasSubstr("damaged greeting"));
}

}  // namespace
}  // namespace patina::devices::host
