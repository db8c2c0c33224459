// SPDX-License-Identifier: GPL-3.0-or-later
// The library itself. Where a camera is attached, $PATINA_LIBCAMERA_CAMERA is its id ("any": the
// first) and $PATINA_LIBCAMERA_UNPLUG a folder of sysfs with `bind` and `unbind`, and what to write
// there: "/sys/bus/platform/drivers/vimc vimc.0". The guest of tests/guest has both.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "devices/libcamera/libcamera_devices.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string attachedId() {
  const char* id = std::getenv("PATINA_LIBCAMERA_CAMERA");
  if (!id) return {};
  if (id != std::string("any")) return id;
  const auto all = devices::libcamera::find();
  return all.empty() ? "none is attached" : all.front().serial;
}

std::unique_ptr<Camera> cameraNamed(const std::string& id, Clock& clock,
                                    std::map<std::string, std::string> settings = {}) {
  CameraSpec spec;
  spec.id = "cam0";
  spec.backend = "libcamera";
  spec.serial = id;
  spec.settings = std::move(settings);
  spec.settings.emplace("fixed_exposure", "1/50");
  spec.settings.emplace("width_px", "240");  // the emulated machine is slow
  spec.settings.emplace("height_px", "180");
  return devices::libcamera::makeCamera(spec, "rig.toml", clock);
}

Exposure fixed() {
  Exposure exposure;
  exposure.time = 20ms;
  return exposure;
}

TEST(LibcameraPipeline, ACameraThatIsNotThereIsLostWithWhatIsInstead) {
  RealClock clock;
  const auto camera = cameraNamed("no such camera", clock);
  const auto opened = camera->recover(Rung::kReopen);
  ASSERT_THAT(opened, Fails(Errc::kLost));
  EXPECT_THAT(opened.error().what, HasSubstr("no camera 'no such camera' is attached; there are:"));
  EXPECT_THAT(camera->recover(Rung::kReset), Fails(Errc::kLost));
}

class AttachedCamera : public ::testing::Test {
 protected:
  void SetUp() override {
    id_ = attachedId();
    if (id_.empty()) GTEST_SKIP() << "PATINA_LIBCAMERA_CAMERA names no camera";
  }
  Result<std::vector<RawFrame>> shoot(Camera& camera, std::uint64_t sequence) {
    const auto ticket = camera.trigger({std::to_string(sequence), sequence});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return camera.collect(*ticket, clock_.mono() + 60s);
  }
  RealClock clock_;
  std::string id_;
};

TEST_F(AttachedCamera, IsFoundWithItsFormatsAndControls) {
  const auto all = devices::libcamera::find();
  ASSERT_FALSE(all.empty());
  const FoundDevice& found = all.front();
  EXPECT_EQ(found.kind, "camera");
  EXPECT_EQ(found.serial, id_);
  EXPECT_EQ(found.state, "ready");
  ASSERT_FALSE(found.choices.empty());
  EXPECT_THAT(found.choices.front().second, Contains("png"));
  for (const auto& [key, value] : found.facts) std::cout << key << ": " << value << "\n";
  for (const Trouble& trouble : found.troubles) std::cout << "trouble: " << trouble.what << "\n";
}

TEST_F(AttachedCamera, TenShotsAreTenPicturesEachAfterItsTrigger) {
  const auto camera = cameraNamed(id_, clock_);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(camera->configure(fixed()), IsOk());
  for (std::uint64_t i = 1; i <= 10; ++i) {
    const MonoTime before = clock_.mono();
    const auto frames = shoot(*camera, i);
    ASSERT_THAT(frames, IsOk());
    const RawFrame& frame = frames->at(0);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_GE(frame.mono, before);
    EXPECT_LE(frame.mono, clock_.mono());
    EXPECT_EQ(decodePicture(frame.bytes).linear.size(), (SizePx{240, 180}));
  }
}

TEST_F(AttachedCamera, TwoProgramsDoNotShareIt) {
  const auto first = cameraNamed(id_, clock_), second = cameraNamed(id_, clock_);
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(second->recover(Rung::kReopen), Fails(Errc::kBusy));
}

TEST_F(AttachedCamera, ASizeItDoesNotHaveIsRefusedWithThoseItHas) {
  const auto camera = cameraNamed(id_, clock_, {{"width_px", "31000"}, {"height_px", "31000"}});
  const auto opened = camera->recover(Rung::kReopen);
  ASSERT_THAT(opened, Fails(Errc::kRefused));
  std::cout << opened.error().what << "\n";
}

TEST_F(AttachedCamera, ADeadlineInThePastIsATimeoutAndTheNextShotIsGood) {
  const auto camera = cameraNamed(id_, clock_);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(camera->configure(fixed()), IsOk());
  const auto ticket = camera->trigger({"a", 1});
  ASSERT_THAT(ticket, IsOk());
  EXPECT_THAT(camera->collect(*ticket, clock_.mono() - 1s), Fails(Errc::kTimeout));
  ASSERT_THAT(camera->recover(Rung::kRetry), IsOk());
  EXPECT_THAT(shoot(*camera, 2), IsOk());
}

TEST_F(AttachedCamera, EachRungLeavesItGoodForAShot) {
  const auto camera = cameraNamed(id_, clock_);
  std::uint64_t sequence = 0;
  for (const Rung rung : {Rung::kReopen, Rung::kRetry, Rung::kDrain, Rung::kReset}) {
    ASSERT_THAT(camera->recover(rung), IsOk()) << name(rung);
    ASSERT_THAT(camera->configure(fixed()), IsOk());
    EXPECT_THAT(shoot(*camera, ++sequence), IsOk()) << name(rung);
  }
}

class UnpluggableCamera : public AttachedCamera {
 protected:
  void SetUp() override {
    AttachedCamera::SetUp();
    const char* where = std::getenv("PATINA_LIBCAMERA_UNPLUG");
    if (!where) GTEST_SKIP() << "PATINA_LIBCAMERA_UNPLUG names no driver";
    const std::string words = where;
    driver_ = words.substr(0, words.find(' '));
    device_ = words.substr(words.find(' ') + 1);
  }
  void write(const std::string& file) {
    std::ofstream out(driver_ + "/" + file);
    out << device_ << std::flush;
    ASSERT_TRUE(out.good()) << file;
  }

 private:
  std::string driver_, device_;
};

// vimc's pipeline, as that of the Pi, is not told of it by the library: the next call is.
TEST_F(UnpluggableCamera, UnpluggedItIsLostAtTheNextShotAndComesBackByItsId) {
  const auto camera = cameraNamed(id_, clock_);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(camera->configure(fixed()), IsOk());
  ASSERT_THAT(shoot(*camera, 1), IsOk());
  write("unbind");
  EXPECT_THAT(shoot(*camera, 2), Fails(Errc::kLost));
  EXPECT_THAT(camera->recover(Rung::kReopen), Fails(Errc::kLost));
  write("bind");
  Result<void> back = fail(Errc::kLost, "");
  for (const MonoTime end = clock_.mono() + 60s; !back && clock_.mono() < end;) {
    clock_.sleepUntil(clock_.mono() + 500ms, {});
    back = camera->recover(Rung::kReopen);
  }
  ASSERT_THAT(back, IsOk());
  ASSERT_THAT(camera->configure(fixed()), IsOk());
  EXPECT_THAT(shoot(*camera, 3), IsOk());
}

}  // namespace
}  // namespace patina::testing
