// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

class CalibrateLights : public ::testing::Test {
 protected:
  // A black ball of 30 pixels at (60, 50), its highlight halfway out to the right, on grey.
  void plantBall(const std::string& file) {
    Image<std::uint8_t> picture(120, 100, 3, 120);
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 120; ++x)
        for (int c = 0; c < 3; ++c) {
          if (std::hypot(x + 0.5 - 60, y + 0.5 - 50) < 30) picture.at(x, y, c) = 20;
          if (std::hypot(x + 0.5 - 75, y + 0.5 - 50) < 2.5) picture.at(x, y, c) = 240;
        }
    std::filesystem::create_directories(folder_ / "sphere");
    writePng(folder_ / "sphere" / file, picture.view());
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(CalibrateLights, WritesALightFile) {
  plantBall("a.png");
  plantBall("b.png");
  const std::string out = folder_ / "dirs.lp";
  const JsonAnswer lights =
      answerOf(runPatina({"calibrate", "lights", folder_ / "sphere", "--out", out, "--json"}));
  EXPECT_EQ(lights.size("/items"), 2u);
  EXPECT_NEAR(lights.number("/items/0/x"), std::sin(M_PI / 3), 0.02);
  EXPECT_NEAR(lights.number("/items/1/sphere_radius_px"), 30, 0.5);
  EXPECT_THAT(readFile(out), ::testing::StartsWith("2\na.png 0.8"));
}

TEST_F(CalibrateLights, RefusesASphereThatTheFrameCutsOff) {
  plantBall("a.png");
  const Finished finished = runPatina({"calibrate", "lights", folder_ / "sphere", "--sphere",
                                       "10,50,30", "--out", folder_ / "dirs.lp"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("cut off by the frame"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "dirs.lp"));
}

TEST_F(CalibrateLights, NeedsAPlaceToWriteToAndASphereThatIsOne) {
  plantBall("a.png");
  EXPECT_EQ(runPatina({"calibrate", "lights", folder_ / "sphere"}).exit, 64);
  EXPECT_EQ(runPatina({"calibrate", "lights", folder_ / "sphere", "--sphere", "1,2", "--out",
                       folder_ / "dirs.lp"})
                .exit,
            64);
}

TEST_F(CalibrateLights, TellsAMirroredLightFileFromATrueOne) {
  PATINA_TEST_DATA_OR_SKIP(icon, "icon_rti");
  const JsonAnswer as_is =
      answerOf(runPatina({"calibrate", "lights", icon, "--check", icon / "dirs.lp", "--json"}));
  EXPECT_THAT(as_is.text("/items/0/verdict"), ::testing::HasSubstr("the lights fit"));
  std::istringstream lines(readFile(icon / "dirs.lp"));
  std::ostringstream mirrored;
  std::string file;
  int count = 0;
  double x = 0, y = 0, z = 0;
  lines >> count;
  mirrored << count << "\n";
  while (lines >> file >> x >> y >> z)
    mirrored << file << " " << -x << " " << y << " " << z << "\n";
  writeFile(folder_ / "mirrored.lp", mirrored.str());
  const Finished finished =
      runPatina({"calibrate", "lights", icon, "--check", folder_ / "mirrored.lp"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.out, ::testing::HasSubstr("x is mirrored"));
}

}  // namespace
}  // namespace patina::testing
