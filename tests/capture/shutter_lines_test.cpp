// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/shutter_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/matchers.h"

namespace patina::capture {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::ElementsAre;

// A line that fails so often before it works.
class Line final : public devices::Trigger {
 public:
  Line(std::string id, int failures, int& fired)
      : id_(std::move(id)), failures_(failures), fired_(fired) {}
  const std::string& id() const override { return id_; }
  devices::Result<MonoTime> fire() override {
    if (failures_-- > 0) return devices::fail(devices::Errc::kLost, "unplugged");
    return monoFromNs(++fired_);
  }
  devices::Result<void> recover() override { return {}; }

 private:
  std::string id_;
  int failures_;
  int& fired_;
};

struct Bench {
  explicit Bench(int failures = 0) {
    add("left", {"cam0", "cam1"}, failures);
    add("right", {"cam2"}, 0);
  }
  void add(const std::string& id, std::vector<std::string> cameras, int failures) {
    devices::TriggerSpec spec;
    spec.id = id;
    spec.cameras = std::move(cameras);
    rig.spec.triggers.push_back(spec);
    rig.triggers.push_back(std::make_unique<Line>(id, failures, fired));
  }
  devices::Rig rig;
  int fired = 0;
};

TEST(ShutterLines, ALineFiresOnceForAllItsCameras) {
  Bench bench;
  ShutterLines lines(bench.rig);
  EXPECT_TRUE(lines.start().empty());
  EXPECT_TRUE(lines.serve("cam1"));
  EXPECT_FALSE(lines.serve("cam3"));
  const auto fired = lines.fire({"cam0", "cam1", "cam3"});
  ASSERT_EQ(fired.size(), 1u);
  EXPECT_THAT(fired[0].cameras, ElementsAre("cam0", "cam1"));
  EXPECT_EQ(bench.fired, 1);
}

TEST(ShutterLines, ALineThatFailsOnceIsRecoveredAndFired) {
  Bench bench(1);
  ShutterLines lines(bench.rig);
  EXPECT_THAT(lines.fire({"cam0"}).at(0).at, IsOk());
}

TEST(ShutterLines, ALineThatStaysDeadIsAnErrorOfItsCamerasAlone) {
  Bench bench(2);
  ShutterLines lines(bench.rig);
  const auto fired = lines.fire({"cam0", "cam2"});
  EXPECT_THAT(fired.at(0).at, Fails(devices::Errc::kLost));
  EXPECT_THAT(fired.at(1).at, IsOk());
}

}  // namespace
}  // namespace patina::capture
