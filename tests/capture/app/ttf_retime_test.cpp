// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class TtfRetime : public Rehearsed {};

TEST_F(TtfRetime, MakesFilmsAtAnyRateAndTexturesThatAgeByAFormula) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const auto retimed = [&](std::vector<std::string> how) {
    how.insert(how.begin(), {"ttf", "retime", file});
    how.insert(how.end(), {"--out", place("r.h5")});
    return answer(how);
  };
  EXPECT_EQ(retimed({"--frames", "31"}).number("/items/0/frames"), 31);
  const auto lit =
      retimed({"--rate", "0.5 + 0.5*light", "--lamp", "0,0,50", "--mm-per-texel", "1"});
  EXPECT_GT(lit.number("/items/0/rate_least"), 0.49);
  EXPECT_EQ(lit.number("/items/0/rate_greatest"), 1);
}

TEST_F(TtfRetime, RunsOnAMeshUnderASunThatMoves) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const std::string wave = sourceFolder() / "examples/control/sigmoid.obj";
  const auto bent = answer({"ttf", "retime", file, "--mesh", wave, "--rate",
                            "0.1 + 20*abs(curvature)", "--out", place("bent.h5")});
  EXPECT_LT(bent.number("/items/0/rate_least"), 0.3);
  const auto lit =
      answer({"ttf", "retime", file, "--mesh", wave, "--caster", wave, "--light",
              "cos(pi*t),0,sin(pi*t)", "--rate", "0.2 + light*shadow", "--out", place("lit.h5")});
  EXPECT_GT(lit.number("/items/0/ended_share"), 0);
  EXPECT_LT(lit.number("/items/0/rate_least"), 0.25);
}

TEST_F(TtfRetime, RefusesTwoSurfacesAndMeshesThatAreNone) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  const std::string wave = sourceFolder() / "examples/control/sigmoid.obj";
  writeFile(place("bad.obj"), "v 0 0 0\nf 1 2 3\n");
  const auto exit = [&](std::vector<std::string> how) {
    how.insert(how.begin(), {"ttf", "retime", file, "--rate", "slope", "--out", place("no.h5")});
    return patina(how).exit;
  };
  EXPECT_EQ(exit({"--mesh", wave, "--height", "h.png"}), 64);
  EXPECT_EQ(exit({"--mesh", place("bad.obj")}), 65);
  EXPECT_EQ(exit({"--mesh", place("none.glb")}), 65);
  EXPECT_EQ(exit({"--mesh", wave, "--mesh-turn", "90"}), 64);
  EXPECT_EQ(exit({"--light", "1,2"}), 64);
  EXPECT_FALSE(std::filesystem::exists(place("no.h5")));
}

TEST_F(TtfRetime, RefusesAFormulaOfWhatIsNotThere) {
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  for (const char* rate : {"speed", "map", "x +"})
    EXPECT_EQ(patina({"ttf", "retime", file, "--rate", rate, "--out", place("no.h5")}).exit, 64);
  EXPECT_EQ(patina({"ttf", "retime", file, "--rate", "-1", "--out", place("no.h5")}).exit, 64);
  EXPECT_EQ(patina({"ttf", "retime", file, "--out", place("no.h5")}).exit, 64);
  EXPECT_FALSE(std::filesystem::exists(place("no.h5")));
}

}  // namespace
}  // namespace patina::testing
