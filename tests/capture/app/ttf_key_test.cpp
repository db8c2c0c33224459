// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class TtfKey : public Rehearsed {
 protected:
  // A picture of the ball on the cardboard of the example.
  static std::string photo() {
    const std::string file = place("photo.png");
    if (!std::filesystem::exists(file)) {
      const Finished finished = patina({"render", sourceFolder() / "examples/control/ball.toml",
                                        "--size", "128x128", "--samples", "64", "--out", file});
      EXPECT_EQ(finished.exit, 0) << finished.err;
    }
    return file;
  }
};

TEST_F(TtfKey, TakesTheBallAndItsShadowOffAndLaysThemOverATexture) {
  const JsonAnswer keyed =
      answer({"ttf", "key", photo(), "--background", "#58c068", "--out", place("ball")});
  EXPECT_NEAR(keyed.number("/items/0/object_share"), 0.12, 0.04);
  EXPECT_NEAR(keyed.number("/items/0/shadow_share"), 0.1, 0.08);
  const Picture mask = readPicture(place("ball") + "/mask.png"),
                shadow = readPicture(place("ball") + "/shadow.png");
  EXPECT_EQ(mask.linear.at(69, 58), 1);
  EXPECT_EQ(mask.linear.at(5, 5), 0);
  EXPECT_LT(shadow.linear.at(42, 78), 0.3);
  EXPECT_GT(shadow.linear.at(110, 20), 0.8);

  const std::string texture = answer({"ttf", "list"}).text("/items/0/path");
  const JsonAnswer info = answer({"ttf", "info", texture});
  if (info.number("/items/0/width_px") == info.number("/items/0/height_px")) {
    EXPECT_EQ(patina({"film", texture, place("over.mp4"), "--overlay", place("ball")}).exit, 0);
    EXPECT_EQ(patina({"sheet", texture, place("over.png"), "--overlay", place("ball")}).exit, 0);
  } else {
    EXPECT_EQ(patina({"film", texture, place("over.mp4"), "--overlay", place("ball")}).exit, 64);
  }
}

TEST_F(TtfKey, RefusesWhatIsNoBackgroundAndLeavesNothing) {
  const auto key = [&](const std::string& background) {
    return patina({"ttf", "key", photo(), "--background", background, "--out", place("no")}).exit;
  };
  EXPECT_EQ(key("#58c0"), 64);
  EXPECT_EQ(key("#2020c0"), 65);
  EXPECT_EQ(key(place("none.png")), 65);
  EXPECT_FALSE(std::filesystem::exists(place("no")));
}

}  // namespace
}  // namespace patina::testing
