// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(TwinSpecimens, AreListedByTheirNames) {
  EXPECT_THAT(runPatina({"twin", "specimens"}).out, HasSubstr("banana_ripening"));
  EXPECT_GE(answerOf(runPatina({"twin", "specimens", "list", "--json"})).size("/items"), 2u);
}

TEST(TwinSpecimens, AreRenderedAsMapsWithTheirDegree) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string out = folder / "set";
  const std::vector<std::string> command = {"twin",   "specimens", "render", "copper_patination",
                                            "--time", "0.5",       "--size", "64x48",
                                            "--out",  out};
  EXPECT_EQ(runPatina(command).exit, 0);
  for (const char* map : {"Diffuse", "Specular", "Roughness", "Normal", "Height", "degree"})
    EXPECT_EQ(readPicture(out + "/" + map + ".exr").linear.size(), (SizePx{64, 48})) << map;
  EXPECT_THAT(readFile(out + "/manifest.json"), HasSubstr("copper_patination"));
  EXPECT_EQ(runPatina(command).exit, 73);  // it is there already
}

TEST(TwinSpecimens, ThatDoNotExistAreNamedBesideThoseThatDo) {
  const TempFolder folder = TempFolder::inMemory();
  const Finished finished =
      runPatina({"twin", "specimens", "render", "toast", "--out", folder / "x"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("banana_ripening"));
}

}  // namespace
}  // namespace patina::testing
