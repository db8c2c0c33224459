// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/encoding.h"
#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Degree 1: waves that fade to half.
fs::path plantSet(const fs::path& folder) {
  fs::create_directories(folder);
  Image<float> colour(32, 28, 3), change(32, 28, 3);
  for (int y = 0; y < 28; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c) {
        colour.at(x, y, c) = static_cast<float>(0.5 + 0.3 * std::sin(0.6 * x) * std::cos(0.5 * y));
        change.at(x, y, c) = -0.5f * colour.at(x, y, c);
      }
  writeExr(folder / "Diffuse-0.exr", colour.view());
  writeExr(folder / "Diffuse-1.exr", change.view());
  for (const std::string map : {"Specular", "Roughness"}) {
    writeExr(folder / (map + "-0.exr"), Image<float>(32, 28, 1, 0.3f).view());
    writeExr(folder / (map + "-1.exr"), Image<float>(32, 28, 1).view());
  }
  return folder;
}

TEST(StbrdfTransfer, WritesASetThatIsThePictureAtItsTime) {
  const TempFolder temp;
  const fs::path set = plantSet(temp / "set"), out = temp / "out";
  Image<std::uint8_t> picture(50, 40, 3);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<std::uint8_t>(60 + 3 * x + y);
  writePng(temp / "p.png", picture.view());
  const Finished finished =
      runPatina({"stbrdf", "transfer", set, temp / "p.png", out, "--time", "1"});
  ASSERT_EQ(finished.exit, 0) << finished.err;
  const Image<float> constant = readPicture(out / "Diffuse-0.exr").linear,
                     slope = readPicture(out / "Diffuse-1.exr").linear,
                     wanted = decodeSrgb(picture.view());
  for (std::size_t i = 0; i < wanted.texels().size(); ++i)
    ASSERT_NEAR(constant.texels()[i] + slope.texels()[i], wanted.texels()[i], 1e-5);
}

TEST(StbrdfTransfer, RefusesWhatCannotBeAndLeavesNothing) {
  const TempFolder temp;
  const fs::path set = plantSet(temp / "set"), out = temp / "out";
  writePng(temp / "small.png", Image<std::uint8_t>(4, 40, 3, 99).view());
  const Finished small = runPatina({"stbrdf", "transfer", set, temp / "small.png", out});
  EXPECT_EQ(small.exit, 64);
  EXPECT_THAT(small.err, HasSubstr("smaller than the patch"));
  EXPECT_EQ(runPatina({"stbrdf", "transfer", set, temp / "none.png", out}).exit, 65);
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace patina::testing
