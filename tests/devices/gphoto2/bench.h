// SPDX-License-Identifier: GPL-3.0-or-later
// The driver against the virtual DSLR over PTP/IP, in time that runs faster than the real one: the
// second it takes to see a camera's clock tick is then a tenth.
#pragma once

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "devices/gphoto2/gphoto2.h"
#include "devices/scaled_clock.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/matchers.h"

namespace patina::devices::gphoto2 {

using testing::Fails;
using testing::IsOk;
using twin::dslr::Dslr;
using twin::dslr::DslrFault;
using twin::dslr::DslrFaultKind;
using twin::dslr::DslrOptions;
using twin::dslr::Operation;
using twin::dslr::PtpIpServer;
using twin::dslr::TruePicture;

constexpr double kSpeed = 10;
// With a picture that will come, beside whatever else the machine does: six real seconds.
constexpr Nanoseconds kPatience = std::chrono::seconds(60);

using SettingsMap = std::map<std::string, std::string>;

// A body on the wire.
struct Body {
  explicit Body(Clock& clock, DslrOptions options = {})
      : camera(twin::dslr::dslrWorld(clock), std::move(options)),
        server(std::make_unique<PtpIpServer>(camera)) {}
  std::string address() const { return "127.0.0.1:" + std::to_string(server->port()); }

  Dslr camera;
  std::unique_ptr<PtpIpServer> server;
};

inline DslrOptions serial(const std::string& number) {
  DslrOptions options;
  options.serial = number;
  return options;
}

inline CameraSpec specOf(const std::string& hosts, const std::string& number,
                         SettingsMap settings = {}) {
  CameraSpec spec;
  spec.id = "cam0";
  spec.backend = "gphoto2";
  spec.serial = number;
  spec.settings = std::move(settings);
  spec.settings.emplace("host", hosts);
  spec.settings.emplace("format", "jpeg");
  spec.settings.emplace("cycle", "0.2s");
  return spec;
}

class DriverTest : public ::testing::Test {
 protected:
  void use(DslrOptions options, SettingsMap settings = {}) {
    body_ = std::make_unique<Body>(clock_, std::move(options));
    make(std::move(settings));
  }
  void make(SettingsMap settings) {
    driver_ = makeCamera(specOf(body_->address(), "1001", std::move(settings)), "rig.toml", clock_);
  }
  Camera& driver() { return *driver_; }
  Dslr& camera() { return body_->camera; }
  void open() {
    if (!body_) use(serial("1001"));
    ASSERT_THAT(driver().recover(Rung::kReopen), IsOk());
    ASSERT_THAT(driver().configure({}), IsOk());
  }
  static ShotRequest request(std::uint64_t sequence) {
    return {"shot " + std::to_string(sequence), sequence};
  }
  MonoTime within(Nanoseconds d) { return clock_.mono() + d; }

  Result<std::vector<RawFrame>> tryShot(std::uint64_t sequence, Nanoseconds deadline = kPatience) {
    told_ = clock_.mono();
    const auto ticket = driver().trigger(request(sequence));
    if (!ticket) return tl::make_unexpected(ticket.error());
    return driver().collect(*ticket, within(deadline));
  }
  // What the camera really did, and whether these are the files of it.
  const TruePicture* truthOf(const std::vector<RawFrame>& frames) {
    truth_ = camera().truth();
    for (const TruePicture& picture : truth_.pictures) {
      std::size_t same = 0;
      for (const RawFrame& frame : frames)
        for (const auto& file : picture.files) same += file.hash == sha256(frame.bytes);
      if (same == frames.size()) return &picture;
    }
    return nullptr;
  }
  // A good shot: its files are of a picture that was really exposed after the trigger.
  void expectGoodShot(std::uint64_t sequence) {
    const auto frames = tryShot(sequence);
    ASSERT_THAT(frames, IsOk());
    expectOurs(*frames);
  }
  void expectOurs(const std::vector<RawFrame>& frames) {
    const TruePicture* picture = truthOf(frames);
    ASSERT_TRUE(picture);
    EXPECT_FALSE(picture->stale);
    EXPECT_GE(picture->begin_mono, told_);
  }
  std::size_t onCard() {
    std::size_t files = 0;
    for (const TruePicture& picture : camera().truth().pictures)
      for (const auto& file : picture.files) files += !file.deleted_utc && !file.lost;
    return files;
  }
  std::string events() {
    std::string text;
    const auto events = driver().poll();
    EXPECT_THAT(events, IsOk());
    if (events)
      for (const CameraEvent& event : *events) text += event.what + "\n";
    return text;
  }

  RealClock real_;
  ScaledClock clock_{real_, kSpeed};
  std::unique_ptr<Body> body_;
  std::unique_ptr<Camera> driver_;
  MonoTime told_;
  twin::dslr::Truth truth_;
};

}  // namespace patina::devices::gphoto2
