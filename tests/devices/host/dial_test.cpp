// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/dial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using ::testing::HasSubstr;

TEST(Dial, ReachesWhoListens) {
  const RealClock clock;
  const auto listener = listenOn("127.0.0.1:0");
  ASSERT_TRUE(listener);
  EXPECT_THAT(acceptFrom(*listener), Fails(Errc::kTimeout));
  const auto there = dial("127.0.0.1:" + std::to_string(portOf(*listener)), clock.mono() + 10s);
  ASSERT_TRUE(there);
  const auto here = acceptFrom(*listener);
  ASSERT_TRUE(here);
  ASSERT_EQ(send(there->fd(), "x", 1, 0), 1);
  char got = 0;
  EXPECT_EQ(recv(here->fd(), &got, 1, 0), 1);
  EXPECT_EQ(got, 'x');
}

TEST(Dial, NobodyThereIsALossThatSaysWhatToDo) {
  const RealClock clock;
  const auto listener = listenOn("127.0.0.1:0");
  const std::string address = "127.0.0.1:" + std::to_string(portOf(*listener));
  EXPECT_THAT(listenOn(address), Fails(Errc::kLost));  // taken
  const auto closed = dial("127.0.0.1:1", clock.mono() + 10s);
  EXPECT_THAT(closed, Fails(Errc::kLost));
  EXPECT_THAT(closed.error().what, HasSubstr("device-host --listen"));
  EXPECT_THAT(dial("pi", clock.mono() + 10s), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::host
