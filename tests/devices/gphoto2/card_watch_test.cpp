// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/card_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::devices::gphoto2 {
namespace {

using ::testing::HasSubstr;

constexpr FileKinds kJpeg{.jpeg = true}, kPair{.raw = true, .jpeg = true};

CardFile file(const std::string& name) { return {"/store/DCIM", name}; }

TEST(CardWatch, AFileThatIsAnnouncedTwiceCameOnce) {
  CardWatch watch("cam0");
  watch.added(file("DSC_0001.JPG"), monoFromNs(1));
  watch.added(file("DSC_0001.JPG"), monoFromNs(2));
  const auto shot = watch.complete(kJpeg);
  ASSERT_TRUE(shot.has_value());
  ASSERT_EQ(shot->size(), 1u);
  EXPECT_EQ((*shot)[0].at, monoFromNs(1));
  watch.claim(*shot);
  watch.added(file("DSC_0001.JPG"), monoFromNs(3));
  EXPECT_FALSE(watch.complete(kJpeg).has_value());
}

TEST(CardWatch, APairIsWholeWhenBothFilesOfOneNumberAreThere) {
  CardWatch watch("cam0");
  watch.added(file("DSC_0001.JPG"), monoFromNs(1));
  watch.added(file("DSC_0002.NEF"), monoFromNs(2));
  EXPECT_FALSE(watch.complete(kPair).has_value());
  EXPECT_THAT(watch.waitingFor(), HasSubstr("DSC_0002.NEF"));
  watch.added(file("DSC_0002.JPG"), monoFromNs(3));
  const auto shot = watch.complete(kPair);
  ASSERT_TRUE(shot.has_value());
  EXPECT_EQ((*shot)[0].file.name, "DSC_0002.NEF");
  EXPECT_EQ((*shot)[1].file.name, "DSC_0002.JPG");
}

TEST(CardWatch, WhatNoShotClaimsIsToldOnceAndForgotten) {
  CardWatch watch("cam0");
  watch.added(file("DSC_0007.JPG"), monoFromNs(1));
  watch.disownAll("it was taken before the trigger");
  const auto events = watch.takeEvents();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_THAT(events[0].what,
              HasSubstr("unclaimed picture /store/DCIM/DSC_0007.JPG: it was taken"));
  EXPECT_TRUE(watch.takeEvents().empty());
  EXPECT_EQ(watch.waitingFor(), "nothing");
}

}  // namespace
}  // namespace patina::devices::gphoto2
