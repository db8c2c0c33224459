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

}  // namespace
}  // namespace patina::testing
