// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/poll_until.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <utility>

#include "devices/descriptor.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

std::array<int, 2> makePipe() {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
  return ends;
}
bool isOpen(int fd) { return fcntl(fd, F_GETFD) != -1; }

TEST(Descriptor, ClosesWhatItOwnsOnceWhereverItMoved) {
  const auto [in, out] = makePipe();
  const Descriptor kept(out);
  {
    Descriptor first(in);
    Descriptor second(std::move(first));
    Descriptor third;
    third = std::move(second);
    EXPECT_TRUE(third.fd() >= 0);
    EXPECT_TRUE(isOpen(in));
  }
  EXPECT_FALSE(isOpen(in));
  EXPECT_TRUE(isOpen(out));
}

TEST(PollUntil, TellsReadyFromTimeoutFromHungUp) {
  const auto [in, out] = makePipe();
  const Descriptor reader(in);
  Descriptor writer(out);
  VirtualClock clock(kStart);
  EXPECT_EQ(pollUntil(in, POLLIN, clock, clock.mono()), Polled::kTimeout);
  EXPECT_EQ(pollUntil(in, POLLIN, clock, clock.mono() - 1h), Polled::kTimeout);
  ASSERT_EQ(write(out, "x", 1), 1);
  writer = Descriptor();
  EXPECT_EQ(pollUntil(in, POLLIN, clock, clock.mono() + 1h), Polled::kReady);
  char c = 0;
  ASSERT_EQ(read(in, &c, 1), 1);
  EXPECT_EQ(pollUntil(in, POLLIN, clock, clock.mono() + 1h), Polled::kHungUp);
}

TEST(PollUntil, NeverEndsBeforeItsDeadline) {
  const auto [in, out] = makePipe();
  const Descriptor reader(in), writer(out);
  RealClock clock;
  const MonoTime deadline = clock.mono() + 5ms;
  EXPECT_EQ(pollUntil(in, POLLIN, clock, deadline), Polled::kTimeout);
  EXPECT_GE(clock.mono(), deadline);
}

}  // namespace
}  // namespace patina::devices
