// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/alpha_png.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

fs::path plantPicture(const fs::path& file) {
  Image<std::uint8_t> picture(32, 28, 3);
  for (int y = 0; y < 28; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c)
        picture.at(x, y, c) =
            static_cast<std::uint8_t>(120 + 90 * std::sin(0.6 * x + c) * std::cos(0.5 * y));
  writePng(file, picture.view());
  return file;
}

TEST(SynthOptimize, MakesALargerPictureAndTellsItsEnergy) {
  const TempFolder temp;
  const fs::path in = plantPicture(temp / "in.png"), out = temp / "out.png";
  const JsonAnswer answer = answerOf(runPatina({"synth", "optimize", in, "--size", "80x64", "--out",
                                                out, "--nnf", temp / "n.npy", "--json"}));
  EXPECT_EQ(answer.number("/items/0/width_px"), 80);
  EXPECT_GT(answer.number("/items/0/energy"), 0);
  EXPECT_EQ(readPicture(out).linear.size(), (SizePx{80, 64}));
  EXPECT_TRUE(fs::exists(temp / "n.npy"));
}

// Where the sample is clear it is dark: the result keeps the two together.
TEST(SynthOptimize, CarriesTransparency) {
  const TempFolder temp;
  Image<std::uint8_t> leaves(40, 40, 4);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool leaf = std::sin(0.7 * x) * std::cos(0.6 * y + 0.2 * x) > 0;
      for (int c = 0; c < 3; ++c) leaves.at(x, y, c) = leaf ? 200 : 20;
      leaves.at(x, y, 3) = leaf ? 255 : 0;
    }
  const fs::path in = temp / "in.png", out = temp / "out.png";
  writeFileAtomically(in, encodeAlphaPng(leaves.view()));
  ASSERT_EQ(runPatina({"synth", "optimize", in, "--size", "80x80", "--out", out}).exit, 0);
  const Bytes file = patina::readFile(out);
  const Image<float> alpha = decodeAlpha(file), colours = decodePicture(file).linear;
  ASSERT_EQ(alpha.size(), (SizePx{80, 80}));
  int clear = 0, apart = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      clear += alpha.at(x, y) < 0.5f;
      apart += (alpha.at(x, y) < 0.1f && colours.at(x, y, 0) > 0.1f) ||
               (alpha.at(x, y) > 0.9f && colours.at(x, y, 0) < 0.3f);
    }
  EXPECT_NEAR(clear / 6400.0, 0.5, 0.1);
  EXPECT_EQ(apart, 0);
  const Finished linear =
      runPatina({"synth", "optimize", in, "--size", "80x80", "--out", temp / "out.exr"});
  EXPECT_EQ(linear.exit, 64);
  EXPECT_THAT(linear.err, HasSubstr("transparency"));
  EXPECT_FALSE(fs::exists(temp / "out.exr"));
}

TEST(SynthOptimize, MakesALargerTextureWithItsHistory) {
  const TempFolder temp;
  const std::string in = temp / "s.h5", out = temp / "out.h5";
  ASSERT_EQ(runPatina({"twin", "specimens", "ttf", "steel_rusting", "--out", in, "--size", "48x48",
                       "--frames", "6"})
                .exit,
            0);
  ASSERT_EQ(runPatina({"synth", "optimize", in, "--size", "96x80", "--out", out, "--tile"}).exit,
            0);
  const JsonAnswer info = answerOf(runPatina({"ttf", "info", out, "--json"}));
  EXPECT_EQ(info.number("/items/0/frames"), 6);
  EXPECT_EQ(info.number("/items/0/width_px"), 96);
}

TEST(SynthOptimize, RefusesWhatCannotBeAndLeavesNothing) {
  const TempFolder temp;
  const fs::path in = plantPicture(temp / "in.png"), out = temp / "out.png";
  const auto refused = [&](const fs::path& to, const std::string& size) {
    const Finished finished = runPatina({"synth", "optimize", in, "--size", size, "--out", to});
    EXPECT_FALSE(fs::exists(to));
    return std::to_string(finished.exit) + " " + finished.err;
  };
  EXPECT_THAT(refused(out, "20x60"), HasSubstr("smaller than the sample, 32x28"));
  EXPECT_THAT(refused(out, "32768x32768"), HasSubstr("GiB of memory"));
  EXPECT_THAT(refused(temp / "out.jpg", "80x80"), HasSubstr("ends in .png or .exr"));
}

}  // namespace
}  // namespace patina::testing
