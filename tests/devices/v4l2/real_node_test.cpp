// SPDX-License-Identifier: GPL-3.0-or-later
// A real kernel driver: PATINA_V4L2_DEVICE=/dev/video0. What the simulated one cannot prove, that
// our idea of a driver is the kernel's. On vivid its error injection too.
#include <gmock/gmock.h>
#include <linux/videodev2.h>

#include <cstdlib>

#include "devices/v4l2/attached.h"
#include "devices/v4l2/controls.h"
#include "devices/v4l2/frame_format.h"
#include "devices/v4l2/v4l2.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

class RealNode : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* device = std::getenv("PATINA_V4L2_DEVICE");
    if (!device) GTEST_SKIP() << "PATINA_V4L2_DEVICE is unset";
    device_ = device;
  }
  // Any node of the driver, whatever its number after a disconnection.
  v4l2::Node node() const {
    const auto found = v4l2::locate({device_, ""}, "test");
    return std::move(*v4l2::Node::open(found ? found->path : device_, "test"));
  }
  std::unique_ptr<Camera> camera(std::map<std::string, std::string> settings = {}) {
    CameraSpec spec;
    spec.id = "cam0";
    spec.backend = "v4l2";
    spec.settings = std::move(settings);
    spec.settings["device"] = device_;
    spec.settings["warm_up_frames"] = "2";  // under emulation each takes its time
    spec.settings["settle_frames"] = "1";
    if (!v4l2::controlFacts(node(), V4L2_CID_EXPOSURE_ABSOLUTE))
      spec.settings["fixed_exposure"] = "1/30";
    if (!spec.settings.contains("size") && !spec.settings.contains("format")) small(spec.settings);
    return v4l2::makeCamera(spec, "rig.toml", clock_);
  }
  void small(std::map<std::string, std::string>& settings) {
    for (const v4l2::OfferedFormat& offered : v4l2::offeredFormats(node())) {
      if (const v4l2::PixelFormat* known = v4l2::formatOf(offered.fourcc)) {
        settings["format"] = known->name;
        if (!offered.sizes.empty()) settings["size"] = text(offered.sizes.front());
        return;
      }
    }
  }
  static std::string text(SizePx s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
  }
  Exposure exposureFor(const Camera& camera) const {
    Exposure exposure;
    exposure.time =
        std::clamp<Nanoseconds>(20ms, camera.caps().exposure_min, camera.caps().exposure_max);
    return exposure;
  }
  Result<RawFrame> shoot(Camera& camera) {
    ++sequence_;
    const auto ticket = camera.trigger({std::to_string(sequence_), sequence_});
    if (!ticket) return tl::make_unexpected(ticket.error());
    auto frames = camera.collect(*ticket, clock_.mono() + 20s);
    if (!frames) return tl::make_unexpected(frames.error());
    EXPECT_GE(frames->at(0).mono, ticket->began_mono);
    EXPECT_LE(frames->at(0).mono, clock_.mono());
    return std::move(frames->at(0));
  }
  // Sets a control of vivid's by its name; skips on another driver.
  bool set(const std::string& name, std::int32_t value) {
    const v4l2::Node opened = node();
    v4l2_queryctrl query{};
    query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    for (; opened.ask(VIDIOC_QUERYCTRL, &query) == 0; query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
      if (reinterpret_cast<const char*>(query.name) != name) continue;
      v4l2_control control{query.id, value};
      return opened.ask(VIDIOC_S_CTRL, &control) == 0;
    }
    return false;
  }

  std::string device_;
  RealClock clock_;
  std::uint64_t sequence_ = 0;
};

TEST_F(RealNode, EveryFormatItOffersGivesAPicture) {
  int formats = 0;
  for (const v4l2::OfferedFormat& offered : v4l2::offeredFormats(node())) {
    const v4l2::PixelFormat* known = v4l2::formatOf(offered.fourcc);
    if (!known || offered.sizes.empty()) continue;
    ++formats;
    SCOPED_TRACE(known->name);
    auto shooting = camera({{"format", known->name}, {"size", text(offered.sizes.front())}});
    ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
    ASSERT_THAT(shooting->configure(exposureFor(*shooting)), IsOk());
    const auto frame = shoot(*shooting);
    ASSERT_THAT(frame, IsOk());
    EXPECT_EQ(frame->ext, shooting->caps().extensions.at(0));
    EXPECT_EQ(decodePicture(frame->bytes).format, sniffFormat(frame->bytes));
    EXPECT_EQ(readPictureHeader(frame->bytes).size, shooting->caps().size);
  }
  RecordProperty("formats", formats);
  EXPECT_GT(formats, 0);
}

TEST_F(RealNode, AHundredStepsAreAHundredPictures) {
  auto shooting = camera();
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  MonoTime last{};
  for (int step = 0; step < 100; ++step) {
    SCOPED_TRACE(step);
    ASSERT_THAT(shooting->configure(exposureFor(*shooting)), IsOk());
    const auto frame = shoot(*shooting);
    ASSERT_THAT(frame, IsOk());
    EXPECT_GT(frame->mono, last);
    last = frame->mono;
    ASSERT_THAT(shooting->poll(), IsOk());
  }
}

TEST_F(RealNode, HalfOfTheFramesDroppedAreToldAndNoShotIsLost) {
  if (!set("Percentage of Dropped Buffers", 50)) GTEST_SKIP() << "not vivid";
  auto shooting = camera();
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  std::size_t told = 0;
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(shoot(*shooting), IsOk());
    told += shooting->poll()->size();
  }
  EXPECT_TRUE(set("Percentage of Dropped Buffers", 0));
  EXPECT_GT(told, 0u);
}

TEST_F(RealNode, AFrameThatTheDriverCallsDamagedIsCorrupt) {
  auto shooting = camera({});
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(shoot(*shooting), IsOk());
  // The button spoils the next frame only, which may be one from before a trigger.
  bool seen = false;
  for (int i = 0; i < 40 && !seen; ++i) {
    const auto ticket = shooting->trigger({"damaged", 1000});
    ASSERT_THAT(ticket, IsOk());
    clock_.sleepUntil(clock_.mono() + Nanoseconds{(i % 10) * 40ms}, {});
    if (!set("Inject V4L2_BUF_FLAG_ERROR", 1)) GTEST_SKIP() << "not vivid";
    const auto frames = shooting->collect(*ticket, clock_.mono() + 20s);
    seen = !frames;
    if (seen) {
      EXPECT_EQ(frames.error().code, Errc::kCorrupt) << frames.error().what;
    }
  }
  EXPECT_TRUE(seen);
  EXPECT_THAT(shoot(*shooting), IsOk());
}

TEST_F(RealNode, ErrorsOfTheDriverAreErrorsAndItOpensAgain) {
  for (const char* fault : {"Inject VIDIOC_REQBUFS Error", "Inject VIDIOC_STREAMON Error"}) {
    auto shooting = camera();
    if (!set(fault, 1)) GTEST_SKIP() << "not vivid";
    EXPECT_FALSE(shooting->recover(Rung::kReopen)) << fault;
    ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk()) << fault;
    EXPECT_THAT(shoot(*shooting), IsOk());
  }
  auto shooting = camera();
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(shoot(*shooting), IsOk());
  ASSERT_TRUE(set("Inject Fatal Streaming Error", 1));
  EXPECT_THAT(shoot(*shooting), Fails(Errc::kLost));
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(shoot(*shooting), IsOk());
}

TEST_F(RealNode, ADisconnectedOneIsLostAndFoundAgain) {
  auto shooting = camera();
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(shoot(*shooting), IsOk());
  if (!set("Disconnect", 1)) GTEST_SKIP() << "not vivid";
  EXPECT_THAT(shoot(*shooting), Fails(Errc::kLost));
  ASSERT_THAT(shooting->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(shoot(*shooting), IsOk());
}

TEST_F(RealNode, IsFoundWithItsFormats) {
  bool found = false;
  for (const FoundDevice& device : v4l2::find())
    for (const auto& [key, choices] : device.choices)
      found = found || (key == "format" && !choices.empty());
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace patina::testing
