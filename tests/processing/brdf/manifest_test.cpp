// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/manifest.h"

#include <gmock/gmock.h>

#include "processing/image/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::brdf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Manifest, SaysInJsonWhatItWasToldAndReadsItBack) {
  Manifest told;
  told.text("model", "ggx").number("scale", 0.125).count("seed", 7);
  told.set("times", std::vector<double>{0, 0.5, 1}).set("maps", std::vector<std::string>{"A", "B"});
  const Manifest read = Manifest::parse(told.json(), "m");
  EXPECT_EQ(read.text("model"), "ggx");
  EXPECT_EQ(read.number("scale"), 0.125);
  EXPECT_EQ(read.number("seed"), 7);
  EXPECT_THAT(*read.numbers("times"), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(*read.texts("maps"), ElementsAre("A", "B"));
  EXPECT_EQ(read.json(), told.json());
}

TEST(Manifest, IsNotWhatItDoesNotHold) {
  const Manifest m = Manifest::parse(R"({"a":"x","b":null,"c":{"d":1},"e":[1,"x"]})", "m");
  EXPECT_FALSE(m.number("a"));
  EXPECT_FALSE(m.text("z"));
  EXPECT_FALSE(m.has("b"));
  EXPECT_FALSE(m.has("c"));
  EXPECT_FALSE(m.has("e"));
}

TEST(Manifest, RefusesWhatIsNoObjectAndNamesTheFile) {
  for (const char* bad : {"", "[1]", "{\"a\":", "7"}) try {
      Manifest::parse(bad, "set/manifest.json");
      FAIL() << bad;
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kBadData);
      EXPECT_THAT(e.what(), HasSubstr("set/manifest.json"));
    }
}

TEST(Manifest, OfAFolderWithoutOneIsAnError) {
  const patina::testing::TempFolder folder;
  EXPECT_THROW(readManifest(folder.path()), ProcessingError);
}

}  // namespace
}  // namespace patina::brdf
