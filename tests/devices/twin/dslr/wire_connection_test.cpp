// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/wire_connection.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "processing/image/failure.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

constexpr MonoTime kNow = monoFromNs(1'000'000'000);

class WireConnectionTest : public ::testing::Test {
 protected:
  WireConnectionTest() {
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends), 0);
    connection_.emplace(Socket(ends[0]));
    other_ = Socket(ends[1]);
  }
  Bytes received() {
    Bytes bytes(4096);
    const ssize_t n = read(other_.fd(), bytes.data(), bytes.size());
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }

  std::optional<WireConnection> connection_;
  Socket other_;
  const Bytes hundred_ = Bytes(100, std::byte{7});
};

TEST_F(WireConnectionTest, SendsWhatIsQueued) {
  connection_->queue(hundred_);
  EXPECT_FALSE(connection_->isIdle());
  connection_->send(kNow);
  EXPECT_TRUE(connection_->isIdle());
  EXPECT_EQ(received(), hundred_);
}

TEST_F(WireConnectionTest, StallsAtItsByteUntilItsTime) {
  connection_->queue(hundred_, {WireTrouble::kStall, 0.3, 2s});
  connection_->send(kNow);
  EXPECT_EQ(received().size(), 30u);
  EXPECT_EQ(connection_->stalledUntil(), kNow + 2s);
  EXPECT_FALSE(connection_->isIdle());
  connection_->goOn(kNow + 1s);
  connection_->send(kNow + 1s);
  EXPECT_TRUE(received().empty());
  connection_->goOn(kNow + 2s);
  connection_->send(kNow + 2s);
  EXPECT_EQ(received().size(), 70u);
}

TEST_F(WireConnectionTest, SendsNothingBeforeATroubleAtTheBeginningAndNotAllBeforeOneAtTheEnd) {
  connection_->queue(hundred_, {WireTrouble::kStall, 0, kForEver});
  connection_->send(kNow);
  EXPECT_TRUE(received().empty());
  EXPECT_EQ(connection_->stalledUntil(), MonoTime::max());
  connection_->goOn(kNow + 24h);
  EXPECT_FALSE(connection_->wantsToSend());
}

TEST_F(WireConnectionTest, ClosesAtItsByte) {
  connection_->queue(hundred_, {WireTrouble::kClose, 1, {}});
  connection_->send(kNow);
  EXPECT_FALSE(connection_->isOpen());
  EXPECT_EQ(received().size(), 99u);
}

TEST_F(WireConnectionTest, ClosesForGarbageAndForTheOtherSidesEnd) {
  ASSERT_EQ(write(other_.fd(), Bytes(8).data(), 8), 8);
  connection_->receive();
  EXPECT_FALSE(connection_->next());
  EXPECT_FALSE(connection_->isOpen());
}

TEST_F(WireConnectionTest, IsOpenUntilTheOtherSideEnds) {
  connection_->receive();
  EXPECT_TRUE(connection_->isOpen());
  other_ = Socket();
  connection_->receive();
  EXPECT_FALSE(connection_->isOpen());
}

TEST(ListenAt, TakesAnyFreePortAndSaysWhich) {
  const Socket one = listenAt("127.0.0.1", 0), other = listenAt("127.0.0.1", 0);
  EXPECT_NE(portOf(one), 0);
  EXPECT_NE(portOf(one), portOf(other));
  EXPECT_THROW(listenAt("127.0.0.1", portOf(one)), Failure);
  EXPECT_THROW(listenAt("camera", 0), Failure);
}

TEST(BindUdp, TakesAnyFreePortAndSaysWhich) {
  const Socket one = bindUdp("127.0.0.1", 0);
  EXPECT_NE(portOf(one), 0);
  EXPECT_THROW(bindUdp("127.0.0.1", portOf(one)), Failure);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
