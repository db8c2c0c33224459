// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "devices/network/network.h"
#include "tests/support/loopback/snapshots.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class SnapshotCamera : public ::testing::Test {
 protected:
  std::unique_ptr<Camera> camera(std::map<std::string, std::string> settings = {}) {
    CameraSpec spec;
    spec.id = "cam0";
    spec.backend = "network";
    spec.settings = std::move(settings);
    spec.settings.emplace("url", "http://" + server_.address() + "/snapshot.jpg");
    spec.settings.emplace("latency", "1ms");
    spec.settings.emplace("fixed_exposure", "1/100");
    return network::makeCamera(spec, "rig.toml", clock_);
  }
  std::unique_ptr<Camera> opened(std::map<std::string, std::string> settings = {}) {
    auto made = camera(std::move(settings));
    EXPECT_THAT(made->recover(Rung::kReopen), IsOk());
    return made;
  }
  Result<RawFrame> shoot(Camera& camera, Nanoseconds within = 20s) {
    const auto ticket = camera.trigger({"shot", 7});
    if (!ticket) return tl::make_unexpected(ticket.error());
    triggered = ticket->began_mono;
    auto frames = camera.collect(*ticket, clock_.mono() + within);
    if (!frames) return tl::make_unexpected(frames.error());
    return frames->at(0);
  }
  // Called on the server's thread; changed only while nobody asks.
  std::function<std::string()> answer = [this] { return ok(jpeg(++number)); };
  std::uint64_t number = 0;
  RealClock clock_;
  MonoTime triggered;
  LoopbackServer server_{[this](Peer& peer) {
    peer.receiveHead();
    peer.send(answer());
  }};
};

TEST_F(SnapshotCamera, GivesTheFileAsItCame) {
  auto cam = opened();
  const auto frame = shoot(*cam);
  ASSERT_THAT(frame, IsOk());
  const std::string file = jpeg(2);
  EXPECT_EQ(frame->ext, "jpg");
  EXPECT_EQ(frame->sequence, 7u);
  ASSERT_EQ(frame->bytes.size(), file.size());
  EXPECT_EQ(std::memcmp(frame->bytes.data(), file.data(), file.size()), 0);
  EXPECT_GE(frame->mono, triggered);
  EXPECT_LE(frame->mono, clock_.mono());
}

TEST_F(SnapshotCamera, TheExposureIsWhatTheRigSaysAndNoOther) {
  auto cam = opened({{"fixed_iso", "400"}});
  EXPECT_THAT(cam->configure({10ms, Iso{400}}), IsOk());
  const auto other = cam->configure({20ms, Iso{400}});
  ASSERT_THAT(other, Fails(Errc::kUnsupported));
  EXPECT_THAT(other.error().what, HasSubstr("fixed to 1/100"));
  EXPECT_THAT(cam->configure({10ms, Iso{100}}), Fails(Errc::kUnsupported));
  CameraSpec silent;
  silent.id = "cam1";
  silent.settings = {{"url", "http://" + server_.address() + "/"}};
  auto unknown = network::makeCamera(silent, "rig.toml", clock_);
  ASSERT_THAT(unknown->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(unknown->configure({10ms}), Fails(Errc::kUnsupported));
}

TEST_F(SnapshotCamera, ATimeoutIsRecoveredAndALostOneToo) {
  auto cam = opened({{"latency", "10s"}});
  EXPECT_THAT(shoot(*cam, 50ms), Fails(Errc::kTimeout));
  EXPECT_THAT(cam->poll(), Fails(Errc::kRefused));
  ASSERT_THAT(cam->recover(Rung::kDrain), IsOk());
  EXPECT_THAT(cam->poll(), IsOk());
  EXPECT_THAT(cam->recover(Rung::kPowerCycle), Fails(Errc::kUnsupported));
  EXPECT_THAT(cam->recover(Rung::kReset), IsOk());
}

TEST_F(SnapshotCamera, ALoginThatIsWrongIsSaidAtTheStart) {
  answer = [] { return status(401, "WWW-Authenticate: Basic realm=\"x\"\r\n"); };
  EXPECT_THAT(camera()->recover(Rung::kReopen), Fails(Errc::kRefused));
}

}  // namespace
}  // namespace patina::testing
