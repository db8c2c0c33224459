// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(OptimizeOptions, KeepTheSampleWhereItShallStayAndHideWhatIsMasked) {
  const TempFolder temp;
  const fs::path set = plantPlainSet(temp / "set"), out = temp / "out";
  const Image<float> colour = readPicture(set / "Diffuse-0.exr").linear;
  Image<float> scratch(24, 20, 1);
  for (int x = 14; x < 24; ++x) scratch.at(x, 10) = 1;
  writeExr(set / "Height-0.exr", scratch.view());
  Image<std::uint8_t> mask(24, 20, 1, 255), keep(60, 48, 1, 0);
  for (int x = 14; x < 24; ++x) mask.at(x, 10) = 0;
  for (int y = 20; y < 30; ++y)
    for (int x = 30; x < 40; ++x) keep.at(x, y) = 255;
  writePng(temp / "mask.png", mask.view());
  writePng(temp / "keep.png", keep.view());
  const Finished finished =
      runPatina({"stbrdf", "enlarge", set, out, "--size", "60x48", "--tile", "--mask",
                 temp / "mask.png", "--keep", temp / "keep.png", "--keep-from", "-28,-18"});
  ASSERT_EQ(finished.exit, 0) << finished.err;
  const Image<float> result = readPicture(out / "Diffuse-0.exr").linear,
                     height = readPicture(out / "Height-0.exr").linear;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 60; ++x) {
      ASSERT_EQ(height.at(x, y, 0), 0) << x << "," << y;
      ASSERT_TRUE(keep.at(x, y) == 0 || result.at(x, y, 0) == colour.at(x - 28, y - 18, 0));
    }
}

TEST(OptimizeOptions, RefuseMasksAndGuidesThatDoNotFit) {
  const TempFolder temp;
  const fs::path set = plantPlainSet(temp / "set"), out = temp / "out";
  const auto refused = [&](std::vector<std::string> arguments) {
    std::vector<std::string> all{"stbrdf", "enlarge", set, out};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Finished finished = runPatina(all);
    EXPECT_FALSE(fs::exists(out));
    return std::to_string(finished.exit) + " " + finished.err;
  };
  EXPECT_THAT(refused({"--size", "60x60", "--keep", temp / "none.png"}), HasSubstr("none.png"));
  writePng(temp / "white.png", Image<std::uint8_t>(24, 20, 1, 255).view());
  EXPECT_THAT(refused({"--size", "60x60", "--keep", temp / "white.png"}),
              HasSubstr("it has to be 60x60"));
  writePng(temp / "black.png", Image<std::uint8_t>(24, 20, 1, 0).view());
  EXPECT_THAT(refused({"--size", "60x60", "--mask", temp / "black.png"}),
              HasSubstr("leaves no whole patch"));
  const std::string both = (temp / "white.png").string() + ":" + (temp / "white.png").string();
  EXPECT_THAT(refused({"--size", "60x60", "--guide", both}), HasSubstr("the result 60x60"));
  EXPECT_THAT(refused({"--size", "60x60", "--guide", both + ":0"}), HasSubstr("weight"));
  EXPECT_THAT(refused({"--size", "60x60", "--guide", "one.png"}), HasSubstr("two pictures"));
}

}  // namespace
}  // namespace patina::testing
