// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/artnet_lamps.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "devices/twin/dslr/wire_connection.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/devices/twin/dslr/op_dmx_packet.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

TEST(DmxAddresses, AreTheLampsOwnNumbersUnlessTheRigSaysOtherwise) {
  RigSpec rig = dslrRig("64x48");
  rig.lights[1].settings = {{"universe", "3"}, {"channel", "17"}};
  const auto addresses = dmxAddresses(rig);
  ASSERT_EQ(addresses.size(), 2u);
  EXPECT_EQ(addresses[0].universe, 0);
  EXPECT_EQ(addresses[0].channel, 1);
  EXPECT_EQ(addresses[1].universe, 3);
  EXPECT_EQ(addresses[1].channel, 17);
  rig.lights[0].settings = {{"channel", "513"}};
  EXPECT_THROW(dmxAddresses(rig), Failure);
}

class ArtNetLampsTest : public ::testing::Test {
 protected:
  void send(const Bytes& packet) {
    const Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(lamps_.port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_GT(sendto(socket.fd(), packet.data(), packet.size(), 0,
                     reinterpret_cast<const sockaddr*>(&to), sizeof to),
              0);
  }
  // Until the lamp is lit as it should be: the packet is on its way.
  bool becomes(std::size_t lamp, double level) {
    for (int i = 0; i < 5000; ++i) {
      if (std::abs(world_->levelsOver(world_->runTime(), 10ms)[lamp] - level) < 0.05) return true;
      clock_.sleepUntil(clock_.mono() + 1ms, {});
    }
    return false;
  }

  RealClock clock_;
  std::shared_ptr<World> world_ = dslrWorld(clock_);
  ArtNetLamps lamps_{world_, {{0, 1}, {1, 5}}};
};

TEST_F(ArtNetLampsTest, ObeyTheirChannelOfTheirUniverse) {
  send(opDmx(0, {255, 0, 0, 0, 255}));
  EXPECT_TRUE(becomes(0, 1));
  EXPECT_TRUE(becomes(1, 0));
  send(opDmx(1, {0, 0, 0, 0, 128}));
  EXPECT_TRUE(becomes(1, 0.5));
  EXPECT_TRUE(becomes(0, 1));
}

TEST_F(ArtNetLampsTest, KeepTheirLevelWhateverElseComes) {
  send(opDmx(0, {255}));
  ASSERT_TRUE(becomes(0, 1));
  send(Bytes(7, std::byte{1}));
  send(opDmx(0, {}));
  send(opDmx(9, {0}));
  send(opDmx(1, {0, 0, 0, 0, 255}));
  EXPECT_TRUE(becomes(1, 1));
  EXPECT_TRUE(becomes(0, 1));
}

}  // namespace
}  // namespace patina::devices::twin::dslr
