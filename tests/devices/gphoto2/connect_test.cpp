// SPDX-License-Identifier: GPL-3.0-or-later
// Who is who: cameras by serial, wherever they answer.
#include "tests/devices/gphoto2/bench.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class Identity : public ::testing::Test {
 protected:
  std::unique_ptr<Camera> driverFor(const std::string& hosts, const std::string& number) {
    return makeCamera(specOf(hosts, number), "rig.toml", clock_);
  }
  std::optional<Sha256> shoot(Camera& driver) {
    const auto ticket = driver.trigger({"shot", ++sequence_});
    if (!ticket) return std::nullopt;
    const auto frames = driver.collect(*ticket, clock_.mono() + kPatience);
    if (!frames) return std::nullopt;
    return sha256(frames->front().bytes);
  }
  static bool took(const Body& body, const Sha256& picture) {
    for (const TruePicture& taken : body.camera.truth().pictures)
      for (const auto& file : taken.files)
        if (file.hash == picture) return true;
    return false;
  }

  RealClock real_;
  ScaledClock clock_{real_, kSpeed};
  std::uint64_t sequence_ = 0;
};

TEST_F(Identity, OfTwoEqualModelsEachDriverTakesItsOwn) {
  Body a(clock_, serial("1001")), b(clock_, serial("1002"));
  const std::string both = a.address() + "," + b.address();
  const auto second = driverFor(both, "1002"), first = driverFor(both, "1001");
  ASSERT_THAT(second->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  const auto of_first = shoot(*first), of_second = shoot(*second);
  ASSERT_TRUE(of_first && of_second);
  EXPECT_TRUE(took(a, *of_first));
  EXPECT_TRUE(took(b, *of_second));
}

// The router gives each the other's address while both are run.
TEST_F(Identity, SwappedAddressesChangeNoFramesOwner) {
  Body a(clock_, serial("1001")), b(clock_, serial("1002"));
  const int port_a = a.server->port(), port_b = b.server->port();
  const std::string both = a.address() + "," + b.address();
  const auto first = driverFor(both, "1001"), second = driverFor(both, "1002");
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(second->recover(Rung::kReopen), IsOk());
  ASSERT_TRUE(shoot(*first) && shoot(*second));

  a.server.reset();
  b.server.reset();
  a.server = std::make_unique<PtpIpServer>(a.camera, "127.0.0.1", port_b);
  b.server = std::make_unique<PtpIpServer>(b.camera, "127.0.0.1", port_a);
  EXPECT_FALSE(shoot(*first));
  EXPECT_FALSE(shoot(*second));
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(second->recover(Rung::kReopen), IsOk());
  for (int i = 0; i < 3; ++i) {
    const auto of_first = shoot(*first), of_second = shoot(*second);
    ASSERT_TRUE(of_first && of_second);
    EXPECT_TRUE(took(a, *of_first));
    EXPECT_TRUE(took(b, *of_second));
  }
}

TEST_F(Identity, AStrangerAtTheAddressIsNamedAndLeftAlone) {
  Body stranger(clock_, serial("1002"));
  const auto driver = driverFor(stranger.address(), "1001");
  const auto up = driver->recover(Rung::kReopen);
  ASSERT_THAT(up, Fails(Errc::kLost));
  EXPECT_THAT(up.error().what, HasSubstr("1001"));
  EXPECT_THAT(up.error().what, HasSubstr("1002"));
  EXPECT_TRUE(stranger.camera.truth().pictures.empty());
}

TEST_F(Identity, ABodyWithoutASerialIsRefusedToWhoAsksForOne) {
  Body nameless(clock_, serial("0000"));
  EXPECT_THAT(driverFor(nameless.address(), "1001")->recover(Rung::kReopen), Fails(Errc::kRefused));
  EXPECT_THAT(driverFor(nameless.address(), "")->recover(Rung::kReopen), IsOk());
}

TEST_F(Identity, NobodyThereIsLostAndSaysWhereItLooked) {
  int port = 0;
  {
    Body gone(clock_, serial("1001"));
    port = gone.server->port();
  }
  const auto up = driverFor("127.0.0.1:" + std::to_string(port), "1001")->recover(Rung::kReopen);
  ASSERT_THAT(up, Fails(Errc::kLost));
  EXPECT_THAT(up.error().what, HasSubstr(std::to_string(port)));
}

TEST_F(Identity, WhatIsFoundHasItsFactsChoicesAndTroubles) {
  DslrOptions options = serial("1001");
  options.clock_off = 90s;
  options.card_bytes = 50'000'000;
  Body body(clock_, options);
  body.camera.set(twin::dslr::Property::kFocusMode, twin::dslr::kAutofocus);
  body.camera.set(twin::dslr::Property::kExposureProgram, twin::dslr::kProgram);
  body.camera.setBattery(15);
  const auto found = find({specOf(body.address(), "1001")}, clock_);
  const auto it = std::ranges::find(found, "1001", &FoundDevice::serial);
  ASSERT_NE(it, found.end());
  EXPECT_EQ(it->kind, "camera");
  EXPECT_EQ(it->backend, "gphoto2");
  EXPECT_EQ(it->model, "Patina DSLR");
  EXPECT_EQ(it->state, "ready");
  std::string facts, choices, troubles;
  for (const auto& [key, value] : it->facts)
    facts.append(key).append("=").append(value).append("\n");
  for (const auto& [key, values] : it->choices)
    choices.append(key).append("=").append(values.front()).append("\n");
  for (const Trouble& trouble : it->troubles) troubles += trouble.what + "\n";
  EXPECT_THAT(facts, HasSubstr("battery=15%"));
  EXPECT_THAT(facts, ::testing::ContainsRegex("clock=.(89[.][5-9]|90[.][0-5]) s"));
  for (const char* key : {"exposures=", "iso=", "f_number=f/1.4", "white_balance=", "format=JPEG"})
    EXPECT_THAT(choices, HasSubstr(key));
  for (const char* what :
       {"autofocus", "exposure is automatic", "battery low", "nearly full", "2.5."})
    EXPECT_THAT(troubles, HasSubstr(what)) << troubles;
}

TEST_F(Identity, ASilentAddressIsFoundAsSilentWithAdvice) {
  const auto found = find({specOf("127.0.0.1:1", "1001")}, clock_);
  const auto it = std::ranges::find(found, "ptpip:127.0.0.1:1:1", &FoundDevice::address);
  ASSERT_NE(it, found.end());
  EXPECT_EQ(it->state, "silent");
  EXPECT_TRUE(it->troubles.front().fatal);
}

}  // namespace
}  // namespace patina::devices::gphoto2
