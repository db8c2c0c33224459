// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/alpha.h"
#include "processing/image/encoding.h"
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

// Leaves are bright and half clear; what is clear is dark.
Image<std::uint8_t> leaves() {
  Image<std::uint8_t> out(40, 40, 4);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool leaf = std::sin(0.7 * x) * std::cos(0.6 * y + 0.2 * x) > 0;
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = leaf ? 200 : 20;
      out.at(x, y, 3) = leaf ? 128 : 0;
    }
  return out;
}

struct Seen {
  Image<float> alpha, straight;  // linear; alpha empty: none
};
Seen readBoth(const fs::path& file) {
  const Bytes bytes = patina::readFile(file);
  Seen out{decodeAlpha(bytes), decodePicture(bytes).linear};
  if (file.extension() == ".exr" && !out.alpha.empty())
    for (int y = 0; y < out.alpha.height(); ++y)
      for (int x = 0; x < out.alpha.width(); ++x)
        for (int c = 0; c < 3; ++c) out.straight.at(x, y, c) /= std::max(out.alpha.at(x, y), 1e-6f);
  return out;
}

// Of 80 x 80 pixels: how many are clear, and how many have a colour that does not go with their
// alpha.
struct Census {
  int clear = 0, apart = 0;
};
Census censusOf(const Seen& seen) {
  constexpr float kBright = 0.578f;  // linear, of 200
  Census out;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      const float alpha = seen.alpha.at(x, y), brightness = seen.straight.at(x, y, 0);
      EXPECT_TRUE(alpha >= 0 && alpha <= 1);
      out.clear += alpha < 0.25f;
      out.apart += alpha > 0.45f && std::abs(brightness - kBright) > 0.15f;
    }
  return out;
}

TEST(SynthOptimize, CarriesTransparencyOfPngAndExrToEither) {
  const TempFolder temp;
  const auto optimised = [&](const fs::path& in, const fs::path& out) {
    const Finished finished = runPatina({"synth", "optimize", in, "--size", "80x80", "--out", out});
    EXPECT_EQ(finished.exit, 0) << finished.err;
    return readBoth(out);
  };
  const Image<std::uint8_t> sample = leaves();
  Image<float> associated(40, 40, 4);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const float alpha = static_cast<float>(sample.at(x, y, 3)) / 255;
      for (int c = 0; c < 3; ++c)
        associated.at(x, y, c) =
            alpha * linearFromSrgb(static_cast<float>(sample.at(x, y, c)) / 255);
      associated.at(x, y, 3) = alpha;
    }
  writeFileAtomically(temp / "leaves.png", encodeAlphaPng(sample.view()));
  writeFileAtomically(temp / "leaves.exr", encodeAlphaExr(associated.view()));
  for (const std::string& from : {std::string("leaves.png"), std::string("leaves.exr")})
    for (const std::string& to : {std::string("to.png"), std::string("to.exr")}) {
      const Seen seen = optimised(temp / from, temp / (from + to));
      ASSERT_EQ(seen.alpha.size(), (SizePx{80, 80}));
      const Census census = censusOf(seen);
      EXPECT_NEAR(census.clear / 6400.0, 0.5, 0.1) << from << " " << to;
      EXPECT_LT(census.apart, 100) << from << " " << to;
    }
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
