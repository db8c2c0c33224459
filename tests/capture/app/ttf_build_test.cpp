// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class TtfVerbs : public Rehearsed {};

TEST_F(TtfVerbs, BuildRefusesARegionThatIsNone) {
  for (const char* region : {"4,8,40", "0,0,0,10", "-1,0,10,10", "100,100,64,64", "a,b,c,d"})
    EXPECT_EQ(patina({"ttf", "build", "--roi", region, "--out", place("no.h5")}).exit, 64)
        << region;
  EXPECT_FALSE(std::filesystem::exists(place("no.h5")));
}

// Copper ages so fast there that no place holds: the places are what is read.
TEST_F(TtfVerbs, BuildReadsPlacesToHoldOnTo) {
  const auto exitOf = [&](const std::string& place_px) {
    return patina({"ttf", "build", "--register", "translation", "--fiducial", place_px,
                   "--fiducial=60,8,40,40", "--out", place("held.h5")})
        .exit;
  };
  EXPECT_NE(exitOf("8,8,40,40"), 64);
  for (const char* wrong : {"8,8,40", "8,8,40,40,9", "8,8,0,40"}) EXPECT_EQ(exitOf(wrong), 64);
}

TEST_F(TtfVerbs, TheDatabaseListsSearchesAndShows) {
  const JsonAnswer list = answer({"ttf", "list"});
  ASSERT_GE(list.size("/items"), 1u);
  EXPECT_EQ(list.text("/items/0/process"), "copper_patination");
  EXPECT_GE(answer({"ttf", "search", "COPPER", "--frames", "12"}).size("/items"), 1u);
  EXPECT_EQ(answer({"ttf", "search", "banana"}).size("/items"), 0u);
  EXPECT_EQ(answer({"ttf", "search", "--humidity-from", "10"}).size("/items"), 0u);
  EXPECT_THAT(answer({"ttf", "show", "latest"}).text("/items/0/options_json"), HasSubstr("key"));
}

TEST_F(TtfVerbs, PlateDrawsARowATexture) {
  answer({"ttf", "plate", place("plate.png"), "--columns", "4", "--cell", "64"});
  EXPECT_GT(readPicture(place("plate.png")).linear.width(), 4 * 64);
}

TEST_F(TtfVerbs, PublishAsksForALicence) {
  const std::string id = answer({"ttf", "list"}).text("/items/0/id");
  EXPECT_EQ(patina({"ttf", "publish", id, "--to", place("out")}).exit, 64);
  answer({"ttf", "publish", id, "--to", place("out"), "--licence", "CC0-1.0"});
  EXPECT_TRUE(std::filesystem::exists(place("out/README.md")));
  EXPECT_EQ(patina({"ttf", "publish", id, "--to", place("out"), "--licence", "CC0-1.0"}).exit, 73);
}

}  // namespace
}  // namespace patina::testing
