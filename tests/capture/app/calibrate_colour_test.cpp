// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/calibration/colour/drawn_chart.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class CalibrateColour : public Rehearsed {
 protected:
  static std::string chart(const calibration::Drawn& drawn = {}) {
    const std::string file = place("chart.exr");
    writeExr(file, calibration::drawChart(drawn).view());
    return file;
  }
};

TEST_F(CalibrateColour, AnswersWithoutAnArchiveAndDrawsWhatItFound) {
  const std::string json = place("colour.json"), picture = place("colour.png");
  const JsonAnswer found = answerOf(runPatina({"calibrate", "colour", chart(), "--chart", "2014",
                                               "--out", json, "--picture", picture, "--json"}));
  EXPECT_EQ(found.text("/items/0/fit"), "3x3");
  EXPECT_LT(found.number("/items/0/delta_e_after"), 0.2);
  EXPECT_EQ(found.size("/items/0/kinds"), 4u);
  EXPECT_THAT(readFile(json), HasSubstr("patina.colour_calibration/1"));
  EXPECT_GT(readPicture(picture).linear.width(), 900);
}

TEST_F(CalibrateColour, KeptInAnArchiveColoursTheNextTexture) {
  EXPECT_EQ(patina({"ttf", "build", "--colour", "srgb", "--out", place("before.h5")}).exit, 65);
  const JsonAnswer kept = answer({"calibrate", "colour", chart(), "--camera", "cam0", "--light",
                                  "key", "--fit", "root2", "--preserve-white"});
  EXPECT_EQ(kept.text("/items/0/light_state"), "key");
  EXPECT_TRUE(std::filesystem::exists(kept.text("/items/0/path")));
  const JsonAnswer built = answer(
      {"ttf", "build", "--colour", "srgb", "--stale-calibration", "--out", place("after.h5")});
  EXPECT_EQ(built.size("/items/0/calibrations"), 1u);
  EXPECT_THAT(built.text("/items/0/calibrations/0"), HasSubstr("colour "));
}

TEST_F(CalibrateColour, RefusesAShadedChartAndLeavesNothingBehind) {
  calibration::Drawn shaded;
  shaded.light = [](double u, double) { return 1 - 0.09 * u; };
  const std::string out = place("shaded.json");
  const Finished finished = runPatina({"calibrate", "colour", chart(shaded), "--out", out});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.err, HasSubstr("in shade or too near a lamp"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(CalibrateColour, RefusesWordsItDoesNotKnow) {
  const std::string picture = chart();
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--corners", "1,2,3"},
                                                {"--chart", "1976"},
                                                {"--fit", "7x7"},
                                                {"--tilt", "100"}}) {
    std::vector<std::string> arguments{"calibrate", "colour", picture};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(runPatina(arguments).exit, 64) << wrong[0];
  }
  EXPECT_EQ(runPatina({"calibrate", "colour", place("none.dng")}).exit, 64);
  EXPECT_EQ(patina({"calibrate", "colour", picture}).exit, 64) << "of which camera?";
}

}  // namespace
}  // namespace patina::testing
