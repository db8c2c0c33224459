// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/lamps.h"

#include <gtest/gtest.h>

#include "tests/capture/fakes.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using devices::Between;

struct Bench {
  devices::VirtualClock clock{parseUtc("2024-05-01")};
  devices::Rig rig;
  std::vector<FakeLight*> lights;

  explicit Bench(const std::vector<std::pair<std::string, Between>>& lamps, bool confirms = false) {
    for (const auto& [id, between] : lamps) {
      devices::LightSpec spec;
      spec.id = id;
      spec.between = between;
      rig.spec.lights.push_back(spec);
      auto light = std::make_unique<FakeLight>(id, confirms);
      lights.push_back(light.get());
      rig.lights.push_back(std::move(light));
    }
  }
};

TEST(Lamps, LightExactlyTheStateAndRestAsTheRigSays) {
  Bench b({{"fill", Between::kOn}, {"key", Between::kOff}, {"rim", Between::kKeep}});
  Lamps lamps(b.rig, b.clock, {"rim"});
  EXPECT_TRUE(lamps.start().empty());
  EXPECT_EQ(b.lights[0]->level, 1);
  EXPECT_EQ(b.lights[1]->level, 0);
  ASSERT_TRUE(lamps.apply({"key", "rim"}, 0s));
  EXPECT_EQ(b.lights[0]->level, 0);
  EXPECT_EQ(b.lights[1]->level, 1);
  EXPECT_EQ(b.lights[2]->level, 1);
  lamps.rest();
  EXPECT_EQ(b.lights[0]->level, 1);
  EXPECT_EQ(b.lights[1]->level, 0);
  EXPECT_EQ(b.lights[2]->level, 1);
  lamps.allOff();
  EXPECT_EQ(b.lights[0]->level + b.lights[2]->level, 0);
}

TEST(Lamps, RestAsAWholeSweepEndsWhateverStateWasLast) {
  Bench b({{"key", Between::kKeep}, {"rim", Between::kKeep}});
  Lamps lamps(b.rig, b.clock, {"rim"});
  lamps.start();
  EXPECT_EQ(b.lights[1]->level, 0);  // nobody has shot yet
  ASSERT_TRUE(lamps.apply({"key"}, 0s));
  lamps.rest();
  EXPECT_EQ(b.lights[0]->level, 0);
  EXPECT_EQ(b.lights[1]->level, 1);
}

TEST(Lamps, AreSettledAfterTheLastOneWentOn) {
  Bench b({{"fill", Between::kOn}, {"key", Between::kOff}});
  Lamps lamps(b.rig, b.clock, {"rim"});
  lamps.start();
  b.clock.advance(1h);
  EXPECT_EQ(*lamps.apply({"fill"}, 2s), b.clock.mono());
  EXPECT_EQ(*lamps.apply({"fill", "key"}, 2s), b.clock.mono() + 2s);
  b.clock.advance(1s);
  EXPECT_EQ(*lamps.apply({"fill", "key"}, 2s), b.clock.mono() + 1s);
}

TEST(Lamps, RecoverALampOnceBeforeTheyGiveUp) {
  Bench b({{"key", Between::kOff}});
  Lamps lamps(b.rig, b.clock, {"rim"});
  b.lights[0]->failures = 1;
  EXPECT_TRUE(lamps.apply({"key"}, 0s));
  EXPECT_EQ(b.lights[0]->recovered, 1);
  b.lights[0]->failures = 2;
  EXPECT_FALSE(lamps.apply({"key"}, 0s));
}

TEST(Lamps, DoNotBelieveALampThatDoesNotConfirm) {
  Bench b({{"key", Between::kOff}}, true);
  Lamps lamps(b.rig, b.clock, {"rim"});
  b.lights[0]->stuck = true;
  const auto lit = lamps.apply({"key"}, 0s);
  ASSERT_FALSE(lit);
  EXPECT_EQ(lit.error().code, devices::Errc::kRefused);
}

}  // namespace
}  // namespace patina::capture
