// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/dmx.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "tests/devices/dmx/node.h"
#include "tests/support/matchers.h"

namespace patina::devices::dmx {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::Node;
using patina::testing::Packet;
using ::testing::HasSubstr;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

using Values = std::map<std::string, std::string>;

LightSpec lamp(const std::string& backend, const Node& node, Values settings) {
  LightSpec spec;
  spec.id = "key";
  spec.backend = backend;
  spec.address = "127.0.0.1";
  settings["port"] = std::to_string(node.port());
  spec.settings = std::move(settings);
  return spec;
}

std::string refusalOf(const LightSpec& spec) {
  VirtualClock clock(kStart);
  try {
    makeLight(spec, "rig.toml", clock);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "no error";
}

class DmxLights : public ::testing::Test {
 protected:
  // Channels 1 to 8 of the last packet.
  std::vector<int> shown(std::size_t header = 18) {
    const auto packets = node_.waiting();
    if (packets.empty()) return {};
    const auto* first = packets.back().data() + header;
    return {first, first + 8};
  }
  Node node_;
  VirtualClock clock_{kStart};
};

TEST_F(DmxLights, LightsItsChannelAndLeavesTheOthersDark) {
  const auto light = makeLight(lamp("artnet", node_, {{"channel", "3"}}), "rig.toml", clock_);
  ASSERT_THAT(light->recover(), IsOk());
  EXPECT_EQ(shown(), (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_EQ(shown(), (std::vector<int>{0, 0, 255, 0, 0, 0, 0, 0}));
  EXPECT_EQ(*light->isOn(), std::nullopt);
}

TEST_F(DmxLights, DrivesSeveralChannelsAt16BitsWithALevelAtFull) {
  const auto light =
      makeLight(lamp("sacn", node_, {{"channels", "1, 5"}, {"bits", "16"}, {"full", "0.5"}}),
                "rig.toml", clock_);
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_EQ(shown(126), (std::vector<int>{128, 0, 0, 0, 128, 0, 0, 0}));
  ASSERT_THAT(light->set(0.5), IsOk());
  EXPECT_EQ(shown(126), (std::vector<int>{64, 0, 0, 0, 64, 0, 0, 0}));
}

TEST_F(DmxLights, TheLeastLevelIsOneStepAndNotDark) {
  const auto light = makeLight(lamp("artnet", node_, {}), "rig.toml", clock_);
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1e-6), IsOk());
  EXPECT_EQ(shown().at(0), 1);
}

TEST_F(DmxLights, ShareTheSenderOfTheirUniverse) {
  LightSpec second = lamp("artnet", node_, {{"channel", "2"}});
  second.id = "fill";
  const auto key = makeLight(lamp("artnet", node_, {{"channel", "1"}}), "rig.toml", clock_);
  auto fill = makeLight(second, "rig.toml", clock_);
  EXPECT_EQ(sharedLine(second), sharedLine(lamp("artnet", node_, {{"channel", "1"}})));
  ASSERT_THAT(key->recover(), IsOk());
  ASSERT_THAT(fill->recover(), IsOk());
  ASSERT_THAT(key->set(1), IsOk());
  ASSERT_THAT(fill->set(1), IsOk());
  EXPECT_EQ(shown(), (std::vector<int>{255, 255, 0, 0, 0, 0, 0, 0}));
  fill.reset();  // its channel goes dark, the other lamp stays
  EXPECT_EQ(shown(), (std::vector<int>{255, 0, 0, 0, 0, 0, 0, 0}));
  second.id = "rim";
  EXPECT_NO_THROW(makeLight(second, "rig.toml", clock_));  // and its channel is free
}

TEST_F(DmxLights, RefuseAChannelThatAnotherLampHas) {
  const auto key =
      makeLight(lamp("artnet", node_, {{"channel", "1"}, {"bits", "16"}}), "rig.toml", clock_);
  LightSpec second = lamp("artnet", node_, {{"channel", "2"}});
  second.id = "fill";
  try {
    makeLight(second, "rig.toml", clock_);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("light 'key' has one of these channels"));
  }
}

TEST_F(DmxLights, FailsWhenNobodyListens) {
  LightSpec spec;
  {
    const Node gone;
    spec = lamp("artnet", gone, {});
  }
  const auto light = makeLight(spec, "rig.toml", clock_);
  static_cast<void>(light->recover());
  const auto set = light->set(1);
  ASSERT_THAT(set, Fails(Errc::kLost));
  EXPECT_THAT(set.error().what, HasSubstr("artnet 'key': set: nobody listens at 127.0.0.1"));
}

TEST_F(DmxLights, RefuseSettingsThatAreNone) {
  const auto with = [&](const Values& values) { return refusalOf(lamp("sacn", node_, values)); };
  EXPECT_THAT(with({{"universe", "0"}}), HasSubstr("1 to 63999"));
  EXPECT_THAT(with({{"channel", "513"}}), HasSubstr("1 to 512"));
  EXPECT_THAT(with({{"channel", "512"}, {"bits", "16"}}), HasSubstr("1 to 511"));
  EXPECT_THAT(with({{"channels", "1,x"}}), HasSubstr("'x' is no channel"));
  EXPECT_THAT(with({{"channels", "4,4"}}), HasSubstr("twice"));
  EXPECT_THAT(with({{"channels", "4"}, {"channel", "4"}}), HasSubstr("one of the two"));
  EXPECT_THAT(with({{"priority", "201"}}), HasSubstr("0 to 200"));
  EXPECT_THAT(with({{"interface", "eth0"}}), HasSubstr("no IPv4 address"));
  EXPECT_THAT(with({{"chanel", "1"}}), HasSubstr("channels"));
  LightSpec named = lamp("artnet", node_, {});
  named.address = "lamp.local";
  EXPECT_THAT(refusalOf(named), HasSubstr("no IPv4 address"));
}

TEST_F(DmxLights, SacnWithoutAnAddressGoesToTheGroupOfItsUniverse) {
  LightSpec spec = lamp("sacn", node_, {{"universe", "258"}});
  spec.address = "";
  EXPECT_THAT(sharedLine(spec), HasSubstr("239.255.1.2"));
}

TEST_F(DmxLights, AnSacnSourceHasTheSameCidAfterARestart) {
  std::vector<Packet> cids;
  for (int i = 0; i < 2; ++i) {
    const auto light = makeLight(lamp("sacn", node_, {}), "rig.toml", clock_);
    ASSERT_THAT(light->recover(), IsOk());
    const auto packets = node_.waiting();
    cids.emplace_back(packets.at(0).begin() + 22, packets.at(0).begin() + 38);
  }
  EXPECT_EQ(cids[0], cids[1]);
  EXPECT_NE(cids[0], Packet(16, 0));
}

}  // namespace
}  // namespace patina::devices::dmx
