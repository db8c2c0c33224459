// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(StbrdfEnlarge, WritesALargerSetAndWhereItCameFrom) {
  const TempFolder temp;
  const fs::path set = plantPlainSet(temp / "set");
  std::vector<std::string> bytes;
  for (const std::string threads : {"1", "8"}) {
    const fs::path out = temp / ("out" + threads), nnf = temp / ("nnf" + threads + ".npy");
    const Finished finished = runPatina({"stbrdf", "enlarge", set, out, "--size", "60x48", "--nnf",
                                         nnf, "--threads", threads, "--json"});
    ASSERT_EQ(finished.exit, 0) << finished.err;
    EXPECT_THAT(finished.out, HasSubstr("patina.stbrdf.enlarge/1"));
    EXPECT_EQ(readPicture(out / "Diffuse-0.exr").linear.size(), (SizePx{60, 48}));
    EXPECT_TRUE(fs::exists(out / "Roughness-0.exr"));
    bytes.push_back(readFile(nnf));
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(StbrdfEnlarge, RefusesWhatCannotBeAndLeavesNothing) {
  const TempFolder temp;
  const fs::path set = plantPlainSet(temp / "set"), out = temp / "out";
  const auto refused = [&](std::vector<std::string> arguments) {
    std::vector<std::string> all{"stbrdf", "enlarge", set, out};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Finished finished = runPatina(all);
    EXPECT_FALSE(fs::exists(out));
    return std::to_string(finished.exit) + " " + finished.err;
  };
  EXPECT_THAT(refused({"--size", "20x60"}), HasSubstr("smaller than the set, 24x20"));
  EXPECT_THAT(refused({"--size", "32768x32768"}), HasSubstr("GiB of memory"));
  EXPECT_THAT(refused({"--size", "60x60", "--weights", "0,0,0"}), HasSubstr("all weights are 0"));
  EXPECT_THAT(refused({"--size", "60x60", "--weights", "1,1"}), HasSubstr("three numbers"));
  EXPECT_THAT(refused({"--size", "60x60", "--patch", "4"}), HasSubstr("allowed: 3, 5, 7"));
  EXPECT_THAT(refused({"--size", "60x60", "--search", "magic"}), HasSubstr("64 "));
}

TEST(StbrdfEnlarge, RefusesASetThatHoldsANaN) {
  const TempFolder temp;
  const fs::path set = plantPlainSet(temp / "set");
  Image<float> colour = readPicture(set / "Diffuse-0.exr").linear;
  colour.at(3, 3, 1) = NAN;
  writeExr(set / "Diffuse-0.exr", colour.view());
  const Finished finished = runPatina({"stbrdf", "enlarge", set, temp / "out", "--size", "60x48"});
  EXPECT_EQ(finished.exit, 65) << finished.err;
  EXPECT_FALSE(fs::exists(temp / "out"));
}

}  // namespace
}  // namespace patina::testing
