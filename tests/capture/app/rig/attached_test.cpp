// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/attached.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "capture/failure.h"
#include "tests/support/loopback/snapshots.h"

namespace patina::rig {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

devices::FoundDevice camera(const std::string& model, const std::string& serial,
                            const std::string& address) {
  devices::FoundDevice found;
  found.kind = "camera";
  found.backend = "gphoto2";
  found.model = model;
  found.serial = serial;
  found.address = address;
  return found;
}

TEST(Attached, TwoOfOneModelWithoutSerialsCannotBeToldApart) {
  std::vector<devices::FoundDevice> all{camera("D800", "", "usb:001,004"),
                                        camera("D800", "", "usb:001,005"),
                                        camera("D800", "77", "usb:001,006")};
  markTwins(all);
  ASSERT_EQ(all[0].troubles.size(), 1u);
  EXPECT_TRUE(all[0].troubles[0].fatal);
  EXPECT_THAT(all[0].troubles[0].what, HasSubstr("usb:001,005"));
  EXPECT_EQ(all[1].troubles.size(), 1u);
  EXPECT_TRUE(all[2].troubles.empty());
}

TEST(Attached, EveryBackendLooksAndNoneHasToFindAnything) {
  const Attached all = findAll(20s, {std::getenv("PATINA_PROGRAM"), "device-host"});
  for (const auto& [backend, why] : all.failures) ADD_FAILURE() << backend << ": " << why;
}

TEST(Attached, ABackendThatDoesNotAnswerIsNamed) {
  const Attached all = findAll(100ms, {"/bin/sleep", "60"});
  std::size_t finders = 0;
  for (const Backend& backend : backends()) finders += backend.find != nullptr;
  EXPECT_EQ(all.failures.size(), finders);
}

devices::RigSpec snapshotRig(const std::string& address) {
  return devices::parseRig(
      "[[camera]]\nid = \"cam0\"\nbackend = \"network\"\n"
      "settings = { url = \"http://" +
          address +
          "/\", fixed_exposure = \"1/100\" }\n"
          "[[camera]]\nid = \"cam1\"\nbackend = \"twin\"\n[twin]\nsize = \"64x48\"\n",
      "rig.toml");
}

std::vector<std::string> deviceHost() { return {std::getenv("PATINA_PROGRAM"), "device-host"}; }

TEST(RequireCameras, OneThatIsNotThereIsNamedWithWhatIsAttachedAndWhatToDo) {
  std::string gone;
  {
    const patina::testing::LoopbackServer server([](patina::testing::Peer&) {});
    gone = server.address();
  }
  devices::RealClock clock;
  try {
    requireCameras(snapshotRig(gone), clock, deviceHost());
    FAIL() << "nobody is there";
  } catch (const capture::CaptureError& error) {
    EXPECT_EQ(error.exit(), Exit::kUnavailable);
    EXPECT_THAT(error.what(), HasSubstr("camera 'cam0' cannot be opened (driver of 'cam0'"));
    EXPECT_THAT(error.what(), HasSubstr("Attached: "));
    EXPECT_THAT(error.what(), HasSubstr("--wait"));
  }
}

TEST(RequireCameras, OneThatOpensIsEnough) {
  const patina::testing::LoopbackServer server([](patina::testing::Peer& peer) {
    peer.receiveHead();
    peer.send(patina::testing::ok(patina::testing::jpeg(1)));
  });
  devices::RealClock clock;
  EXPECT_NO_THROW(requireCameras(snapshotRig(server.address()), clock, deviceHost()));
  EXPECT_GT(server.connections(), 0);
}

TEST(RequireCameras, TheTwinsAreThereAnyway) {
  devices::RealClock clock;
  const auto spec =
      devices::parseRig("[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\n[twin]\n", "rig.toml");
  EXPECT_NO_THROW(requireCameras(spec, clock, {"/bin/false"}));
}

}  // namespace
}  // namespace patina::rig
