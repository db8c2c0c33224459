// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class SynthQuilt : public Rehearsed {};

TEST_F(SynthQuilt, QuiltMakesAnySizeFromATexture) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const auto quilt = [&](const std::string& out, const std::string& threads) {
    answer({"synth", "quilt", file, "--size", "150x170", "--block", "32x32", "--threads", threads,
            "--out", place(out)});
    return readFile(place(out));
  };
  const std::string one = quilt("q1.h5", "1");
  EXPECT_TRUE(one == quilt("q2.h5", "2"));  // no message of megabytes
  EXPECT_EQ(patina({"synth", "quilt", file, "--size", "huge", "--out", place("q3.h5")}).exit, 64);
  answer({"synth", "quilt", file, "--size", "96x80", "--block", "32x32", "--tile", "--out",
          place("q3.h5")});
}

TEST_F(SynthQuilt, SaysWhetherSeamsMayShowAndWhatHelps) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const auto seamRatio = [&](const char* blend) {
    return answer({"synth", "quilt", file, "--size", "150x170", "--block", "32x32", "--blend",
                   blend, "--low-frequency", "drop", "--out", place("q.h5")})
        .number("/items/0/seam_ratio_frames");
  };
  EXPECT_LT(seamRatio("4"), seamRatio("0"));
  EXPECT_EQ(patina({"synth", "quilt", file, "--size", "96x80", "--low-frequency", "away", "--out",
                    place("q.h5")})
                .exit,
            64);
}

TEST_F(SynthQuilt, TakesBlocksFromSeveralTexturesAndLeavesNothingBesideTheResult) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const std::filesystem::path folder = place("out");
  std::filesystem::create_directories(folder);
  const JsonAnswer made = answer({"synth", "quilt", file, file, "--channels-apart", "--size",
                                  "96x80", "--block", "32x32", "--out", folder / "q.h5"});
  EXPECT_THAT(made.text("/items/0/shares"), ::testing::MatchesRegex("[0-9]+% [0-9]+%"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  answer({"ttf", "retime", file, "--rate", "1", "--frames", "3", "--out", place("short.h5")});
  const Finished refused = patina(
      {"synth", "quilt", file, place("short.h5"), "--size", "96x80", "--out", place("refused.h5")});
  EXPECT_EQ(refused.exit, 64);
  EXPECT_THAT(refused.err, ::testing::HasSubstr("input 2 has 3 frames"));
  EXPECT_FALSE(std::filesystem::exists(place("refused.h5.samples")));
}

}  // namespace
}  // namespace patina::testing
