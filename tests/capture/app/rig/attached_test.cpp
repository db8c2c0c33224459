// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/attached.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

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

}  // namespace
}  // namespace patina::rig
