// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cmath>

#include "devices/network/network.h"
#include "tests/devices/network/rtsp_server.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class RtspCamera : public ::testing::Test {
 protected:
  std::unique_ptr<Camera> camera(const std::string& address, const std::string& skip = "1") {
    CameraSpec spec;
    spec.id = "cam0";
    spec.settings = {{"url", "rtsp://" + address + "/live"},
                     {"latency", "1ms"},
                     {"skip_key_frames", skip},
                     {"fixed_exposure", "1/100"}};
    return network::makeCamera(spec, "rig.toml", clock_);
  }
  Result<RawFrame> shoot(Camera& camera, Nanoseconds within = 20s) {
    const auto ticket = camera.trigger({"shot", 3});
    if (!ticket) return tl::make_unexpected(ticket.error());
    triggered = ticket->began_mono;
    auto frames = camera.collect(*ticket, clock_.mono() + within);
    if (!frames) return tl::make_unexpected(frames.error());
    return frames->at(0);
  }
  // Of the grey level that a frame was painted with, limited range.
  static float linearOf(int frame) {
    const float display = static_cast<float>(40 + 4 * frame - 16) / 219.0f;
    return display <= 0.04045f ? display / 12.92f : std::pow((display + 0.055f) / 1.055f, 2.4f);
  }
  RealClock clock_;
  MonoTime triggered;
  RtspFilm film_ = greyFilm(30, 10);
};

TEST_F(RtspCamera, GivesTheFirstKeyFrameAfterTheOneThatMayBeKept) {
  std::string address;
  const LoopbackServer server([&](Peer& peer) { serveRtsp(peer, film_, address); });
  address = server.address();
  for (const int skip : {0, 1}) {
    auto cam = camera(address, std::to_string(skip));
    ASSERT_THAT(cam->recover(Rung::kReopen), IsOk());
    const auto frame = shoot(*cam);
    ASSERT_THAT(frame, IsOk());
    EXPECT_EQ(frame->ext, "png");
    const Picture picture = decodePicture(frame->bytes);
    EXPECT_EQ(picture.linear.size(), (SizePx{64, 48}));
    EXPECT_NEAR(picture.linear.at(30, 20), linearOf(10 * skip), 0.01) << skip;
    EXPECT_GE(frame->mono, triggered);
    EXPECT_LE(frame->mono, clock_.mono());
  }
}

TEST_F(RtspCamera, TheSamePictureAsBeforeIsCorrupt) {
  std::string address;
  const LoopbackServer server([&](Peer& peer) { serveRtsp(peer, film_, address); });
  address = server.address();
  auto cam = camera(address);
  ASSERT_THAT(cam->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(shoot(*cam), IsOk());
  EXPECT_THAT(shoot(*cam), Fails(Errc::kCorrupt));
}

// Whose hands a test moves, from any thread.
class HandClock final : public Clock {
 public:
  UtcTime utc() const override { return utcFromNs(now_ns_); }
  MonoTime mono() const override { return monoFromNs(now_ns_); }
  std::string bootId() const override { return "boot"; }
  bool threadSafe() const override { return true; }
  Wake sleepUntil(MonoTime, std::stop_token) override { return Wake::kDue; }
  void set(MonoTime now) { now_ns_ = now.time_since_epoch().count(); }

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

// A nanosecond before its deadline it still waits, and at its deadline no longer.
TEST_F(RtspCamera, AStreamThatStallsIsWaitedForUntilTheDeadline) {
  HandClock hand;
  const MonoTime deadline = hand.mono() + 1h;
  std::string address;
  std::atomic<int> calls = 0;
  std::atomic<bool> still_there = false;
  const LoopbackServer server([&](Peer& peer) {
    const bool opening = calls++ == 0;
    serveRtsp(peer, film_, address, 5, [&] {
      if (opening) return;
      hand.set(deadline - 1ns);
      still_there = peer.waitForIt(300);
      hand.set(deadline);
    });
  });
  address = server.address();
  CameraSpec spec;
  spec.id = "cam0";
  spec.settings = {{"url", "rtsp://" + address + "/live"}, {"connect_timeout", "60s"}};
  auto cam = network::makeCamera(spec, "rig.toml", hand);
  ASSERT_THAT(cam->recover(Rung::kReopen), IsOk());
  const auto ticket = cam->trigger({"shot", 1});
  ASSERT_THAT(ticket, IsOk());
  EXPECT_THAT(cam->collect(*ticket, deadline), Fails(Errc::kTimeout));
  EXPECT_TRUE(still_there);
  EXPECT_EQ(hand.mono(), deadline);
}

TEST_F(RtspCamera, AServerThatSaysNothingDoesNotOutlastTheDeadline) {
  const LoopbackServer server([](Peer& peer) {
    while (peer.waitForIt(1000)) continue;
  });
  CameraSpec spec;
  spec.id = "cam0";
  spec.settings = {{"url", "rtsp://" + server.address() + "/"},
                   {"latency", "1ms"},
                   {"cycle", "100ms"},
                   {"connect_timeout", "100ms"}};
  auto cam = network::makeCamera(spec, "rig.toml", clock_);
  const auto opened = cam->recover(Rung::kReopen);
  EXPECT_FALSE(opened);
}

TEST_F(RtspCamera, NobodyThereIsLostAndTheMessageHoldsNoPassword) {
  std::string address;
  {
    const LoopbackServer gone([](Peer&) {});
    address = gone.address();
  }
  const auto opened = camera(address)->recover(Rung::kReopen);
  ASSERT_THAT(opened, Fails(Errc::kLost));
  EXPECT_THAT(opened.error().what, HasSubstr("rtsp://" + address));
}

}  // namespace
}  // namespace patina::testing
