// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/samples_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void plantStep(const fs::path& folder, float value, const std::string& manifest) {
  fs::create_directories(folder);
  for (const char* name : {"Diffuse", "Specular", "Roughness"})
    writeExr(folder / (std::string(name) + ".exr"), Image<float>(3, 2, 1, value).view());
  if (!manifest.empty()) patina::testing::writeFile(folder / "manifest.json", manifest);
}

std::string refusal(const std::vector<fs::path>& inputs) {
  try {
    openSamples(inputs);
  } catch (const ProcessingError& e) {
    return e.exit() == Exit::kBadData ? e.what() : "another exit code";
  }
  return "taken";
}

TEST(OpenSamples, TakesTimesFromTheStepsAndFactsFromTheFirst) {
  const TempFolder temp = TempFolder::inMemory();
  plantStep(temp / "t0000", 0.1f, R"({"model":"ward","time":0.25,"mm_per_texel":0.5})");
  plantStep(temp / "t0001", 0.2f, R"({"model":"ward","time":0.5})");
  const SampleSet set = openSamples({temp.path()});
  EXPECT_THAT(set.times, ElementsAre(0.25, 0.5));
  EXPECT_TRUE(set.times_told);
  EXPECT_EQ(set.model, "ward");
  EXPECT_EQ(set.facts.number("mm_per_texel"), 0.5);
  EXPECT_FALSE(set.facts.has("time"));
  Progress progress;
  const TimeSamples samples = readSamples(set, "Roughness", progress);
  ASSERT_EQ(samples.maps.size(), 2u);
  EXPECT_EQ(samples.maps[1].at(2, 1), 0.2f);
  EXPECT_THROW(readSamples(set, "Gloss", progress), ProcessingError);
}

TEST(OpenSamples, StretchesTimesOfTheFoldersManifestOverTheWholeProcess) {
  const TempFolder temp = TempFolder::inMemory();
  for (int i = 0; i < 3; ++i) plantStep(temp / ("t000" + std::to_string(i)), 0.1f, "");
  EXPECT_FALSE(openSamples({temp.path()}).times_told);
  EXPECT_THAT(openSamples({temp.path()}).times, ElementsAre(0, 0.5, 1));
  patina::testing::writeFile(temp / "manifest.json", R"({"times":[100,150,500]})");
  EXPECT_THAT(openSamples({temp.path()}).times, ElementsAre(0, 0.125, 1));
  patina::testing::writeFile(temp / "manifest.json", R"({"times":[100,150]})");
  EXPECT_THAT(refusal({temp.path()}), HasSubstr("tells 2 times; there are 3 steps"));
}

TEST(OpenSamples, TakesSeveralSetsAndSequences) {
  const TempFolder temp = TempFolder::inMemory();
  plantStep(temp / "fresh", 0.1f, R"({"time":0})");
  plantStep(temp / "old", 0.2f, R"({"time":1})");
  EXPECT_THAT(openSamples({temp / "fresh", temp / "old"}).times, ElementsAre(0, 1));
  fs::create_directory(temp / "sequence");
  for (int i = 0; i < 4; ++i)
    writeExr(temp / "sequence" / ("Diffuse.000" + std::to_string(i) + ".exr"),
             Image<float>(3, 2, 3, 0.1f * static_cast<float>(i)).view());
  const SampleSet set = openSamples({temp / "sequence"});
  Progress progress;
  EXPECT_EQ(readSamples(set, "Diffuse", progress).maps[3].at(0, 0, 2), 0.3f);
}

TEST(OpenSamples, NamesWhatIsMissing) {
  const TempFolder temp = TempFolder::inMemory();
  fs::create_directory(temp / "empty");
  EXPECT_THAT(refusal({temp / "empty"}), HasSubstr("neither t0000/Diffuse.exr nor Diffuse.0000"));
  EXPECT_THAT(refusal({temp / "nowhere"}), HasSubstr("cannot be read"));
  plantStep(temp / "set/t0000", 0.1f, R"({"time":0})");
  plantStep(temp / "set/t0001", 0.1f, "");
  EXPECT_THAT(refusal({temp / "set"}), HasSubstr("some do not"));
  fs::remove(temp / "set/t0000/manifest.json");
  fs::remove(temp / "set/t0001/Specular.exr");
  EXPECT_THAT(refusal({temp / "set"}), HasSubstr("t0001/Specular.exr is missing"));
}

TEST(ReadSamples, RefusesAMapThatIsNoNumberSomewhere) {
  const TempFolder temp = TempFolder::inMemory();
  plantStep(temp / "t0000", 0.1f, "");
  plantStep(temp / "t0001", NAN, "");
  const SampleSet set = openSamples({temp.path()});
  Progress progress;
  EXPECT_THROW(readSamples(set, "Diffuse", progress), ProcessingError);
}

}  // namespace
}  // namespace patina::stbrdf
