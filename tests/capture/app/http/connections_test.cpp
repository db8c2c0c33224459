// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/connections.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>

#include "devices/descriptor.h"

namespace patina::http {
namespace {

struct Pair {
  Pair() {
    std::array<int, 2> ends{};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    ours = devices::Descriptor(ends[0]);
    theirs = devices::Descriptor(ends[1]);
  }
  bool isShut() const {
    char byte = 0;
    return recv(theirs.fd(), &byte, 1, MSG_DONTWAIT) == 0;
  }
  devices::Descriptor ours, theirs;
};

Connection connection(const Pair& pair, MonoTime deadline) {
  Connection made;
  made.fd = pair.ours.fd();
  made.peer = "p";
  made.deadline = deadline;
  return made;
}

TEST(Connections, ShutsWhatIsLateAndNothingElse) {
  Connections connections;
  const Pair late, early;
  connections.add(connection(late, monoFromNs(100)));
  connections.add(connection(early, monoFromNs(101)));
  EXPECT_EQ(connections.shutLate(monoFromNs(99)).late, 0u);
  EXPECT_EQ(connections.shutLate(monoFromNs(100)).late, 1u);
  EXPECT_TRUE(late.isShut());
  EXPECT_FALSE(early.isShut());
}

TEST(Connections, CountsALateConnectionOnce) {
  Connections connections;
  const Pair pair;
  connections.add(connection(pair, monoFromNs(100)));
  EXPECT_EQ(connections.shutLate(monoFromNs(200)).late, 1u);
  EXPECT_EQ(connections.shutLate(monoFromNs(300)).late, 0u);
}

TEST(Connections, KeepsAStreamUntilItsPeerHangsUp) {
  Connections connections;
  Pair pair;
  Connection* const stream = connections.add(connection(pair, monoFromNs(100)));
  connections.markStream(stream);
  EXPECT_EQ(connections.shutLate(MonoTime::max() - Nanoseconds(1)).streams, 0u);
  pair.theirs = devices::Descriptor();
  EXPECT_EQ(connections.shutLate(monoFromNs(1)).streams, 1u);
}

TEST(Connections, ForgetsWhatIsRemoved) {
  Connections connections;
  const Pair pair;
  connections.remove(connections.add(connection(pair, monoFromNs(1))));
  EXPECT_EQ(connections.count(), 0u);
  EXPECT_EQ(connections.shutLate(monoFromNs(2)).late, 0u);
  EXPECT_FALSE(pair.isShut());
}

}  // namespace
}  // namespace patina::http
