// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/seal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <thread>

#include "devices/config_file.h"
#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using ::testing::HasSubstr;

struct Pair {
  Pair() {
    auto made = makeChannelEnds();
    caller = std::make_unique<Channel>(std::move(made->ours));
    host = std::make_unique<Channel>(std::move(made->theirs));
  }
  MonoTime soon() const { return clock.mono() + 10s; }
  // The caller's answer, and the host's.
  std::pair<Result<void>, Result<void>> greet(const Key& callers, const Key& hosts) {
    Result<void> at_host;
    std::jthread other([&] { at_host = greetAsHost(*host, hosts, clock.mono() + 1s); });
    auto at_caller = greetAsCaller(*caller, callers, clock.mono() + 1s);
    if (!at_caller) caller.reset();
    other.join();
    return {at_caller, at_host};
  }

  RealClock clock;
  std::unique_ptr<Channel> caller, host;
};

Key key(int n) { return sealOf(Key{}, static_cast<std::uint64_t>(n), {}); }

TEST(Seal, TheSameKeyOpensAChannelThatCarriesMessages) {
  Pair pair;
  const auto [caller, host] = pair.greet(key(1), key(1));
  ASSERT_TRUE(caller && host);
  for (int i = 0; i < 3; ++i) {
    const Bytes message(100, static_cast<std::byte>(i));
    ASSERT_TRUE(pair.caller->send(message, pair.soon()));
    EXPECT_EQ(*pair.host->receive(pair.soon()), message);
    ASSERT_TRUE(pair.host->send(message, pair.soon()));
    EXPECT_EQ(*pair.caller->receive(pair.soon()), message);
  }
}

TEST(Seal, AnotherKeyIsRefusedOnBothSides) {
  Pair pair;
  const auto [caller, host] = pair.greet(key(1), key(2));
  EXPECT_THAT(caller, Fails(Errc::kRefused));
  EXPECT_FALSE(host);
  EXPECT_THAT(caller.error().what, HasSubstr("copy the key file"));
}

TEST(Seal, AChangedRepeatedOrForgedMessageIsFoundOut) {
  for (const int trick : {0, 1, 2}) {
    Pair pair;
    const auto [caller, host] = pair.greet(key(1), key(1));
    ASSERT_TRUE(caller && host);
    // What goes over the wire: taken off it, and played again by somebody in the middle.
    ASSERT_TRUE(pair.caller->send(Bytes(8, std::byte{1}), pair.soon()));
    Bytes wire(4 + 8 + 32);
    ASSERT_EQ(recv(pair.host->fd(), wire.data(), wire.size(), MSG_WAITALL),
              static_cast<ssize_t>(wire.size()));
    if (trick == 0) wire[6] ^= std::byte{1};
    if (trick == 2) wire[20] ^= std::byte{1};
    const int times = trick == 1 ? 2 : 1;
    for (int i = 0; i < times; ++i)
      ASSERT_EQ(send(pair.caller->fd(), wire.data(), wire.size(), 0),
                static_cast<ssize_t>(wire.size()));
    if (trick == 1) {
      EXPECT_TRUE(pair.host->receive(pair.soon()));
    }
    EXPECT_THAT(pair.host->receive(pair.soon()), Fails(Errc::kCorrupt)) << trick;
  }
}

TEST(Seal, StrangersLearnThatTheyAreStrangers) {
  Pair pair;
  ASSERT_TRUE(pair.caller->send(Bytes(45, std::byte{'x'}), pair.soon()));
  EXPECT_THAT(greetAsHost(*pair.host, key(1), pair.soon()), Fails(Errc::kRefused));
}

class KeyFile : public ::testing::Test {
 protected:
  Key read(const std::string& text, mode_t mode = 0600) {
    patina::testing::writeFile(folder_ / "key", text);
    chmod((folder_ / "key").c_str(), mode);
    return readKey(folder_ / "key");
  }
  std::string problem(const std::string& text, mode_t mode = 0600) {
    try {
      read(text, mode);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
};

TEST_F(KeyFile, WhiteSpaceAtItsEndsIsNoPartOfTheKey) {
  EXPECT_TRUE(sameKey(read("0123456789abcdef"), read(" 0123456789abcdef\n")));
  EXPECT_FALSE(sameKey(read("0123456789abcdef"), read("0123456789abcdeF")));
}

TEST_F(KeyFile, AShortOrOpenKeyIsRefused) {
  EXPECT_THAT(problem("secret\n"), HasSubstr("shorter than 16"));
  EXPECT_THAT(problem("0123456789abcdef", 0640), HasSubstr("chmod 600"));
}

}  // namespace
}  // namespace patina::devices::host
