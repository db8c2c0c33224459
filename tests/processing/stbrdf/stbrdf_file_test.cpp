// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/stbrdf_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

StbrdfSet smallSet(int degree) {
  StbrdfSet set{.degree = degree, .basis = basisOf(degree), .maps = {}, .facts = {}};
  std::uint64_t seed = 1;
  for (const auto& [name, channels] :
       {std::pair{"Diffuse", 3}, {"Specular", 1}, {"Roughness", 1}}) {
    TimeMap map{.name = name, .coefficients = {}};
    for (int k = 0; k <= degree; ++k) {
      map.coefficients.emplace_back(5, 4, channels);
      for (float& v : map.coefficients.back().texels())
        v = static_cast<float>((k == 0 ? 0.5 : 0.0) + 0.02 * gaussian(seed++));
    }
    set.maps.push_back(std::move(map));
  }
  return set;
}

void expectSame(const StbrdfSet& a, const StbrdfSet& b) {
  EXPECT_EQ(a.degree, b.degree);
  EXPECT_EQ(a.basis, b.basis);
  ASSERT_EQ(a.maps.size(), b.maps.size());
  for (const TimeMap& map : a.maps) {
    const TimeMap* other = b.find(map.name);
    ASSERT_NE(other, nullptr) << map.name;
    EXPECT_EQ(map.low, other->low);
    EXPECT_EQ(map.high, other->high);
    for (std::size_t k = 0; k < map.coefficients.size(); ++k)
      EXPECT_EQ(map.coefficients[k].texels(), other->coefficients[k].texels()) << map.name << k;
  }
}

std::string refusal(const fs::path& folder) {
  Progress progress;
  try {
    readStbrdfSet(folder, progress);
  } catch (const ProcessingError& e) {
    return e.exit() == Exit::kBadData ? e.what() : "another exit code";
  }
  return "taken";
}

TEST(StbrdfFile, GivesBackWhatWasWritten) {
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  for (const int degree : {0, 3, 9}) {
    StbrdfSet set = smallSet(degree);
    set.maps[1].low = -1;
    set.maps[1].high = 4;
    set.model = "ward";
    set.facts.number("mm_per_texel", 0.25);
    const fs::path folder = temp / std::to_string(degree);
    writeStbrdfSet(folder, set, progress);
    const StbrdfSet back = readStbrdfSet(folder, progress);
    expectSame(set, back);
    EXPECT_EQ(back.model, "ward");
    EXPECT_EQ(back.facts.number("mm_per_texel"), 0.25);
  }
}

TEST(StbrdfFile, ReadsThePublishedSetAndWritesItWithoutLoss) {
  PATINA_TEST_DATA_OR_SKIP(folder, "snowyground_stbrdf");
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  const StbrdfSet set = readStbrdfSet(folder, progress);
  EXPECT_EQ(set.degree, 3);
  EXPECT_EQ(set.maps.size(), 5u);
  EXPECT_EQ(set.size(), (SizePx{512, 512}));
  writeStbrdfSet(temp / "again", set, progress);
  const StbrdfSet back = readStbrdfSet(temp / "again", progress);
  expectSame(set, back);
  EXPECT_EQ(back.find("Height")->coefficients[3].texels(),
            readPicture(folder / "Height-3.exr").linear.texels());
  for (const TimeMap& map : back.maps)
    for (const double t : {0.0, 0.4, 1.0}) {
      const Image<float> values = evaluate(map, back.basis, t, Clamp::kToRange);
      for (const float v : values.texels()) ASSERT_TRUE(v >= 0 && v <= 1) << map.name;
    }
}

TEST(StbrdfFile, NamesTheCoefficientThatIsMissing) {
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  writeStbrdfSet(temp / "set", smallSet(2), progress);
  fs::remove(temp / "set/Roughness-1.exr");
  EXPECT_THAT(refusal(temp / "set"), HasSubstr("Roughness-1.exr is missing"));
  fs::remove(temp / "set/manifest.json");
  EXPECT_THAT(refusal(temp / "set"), HasSubstr("Roughness-1.exr is missing"));
  fs::remove(temp / "set/Diffuse-2.exr");
  EXPECT_THAT(refusal(temp / "set"), HasSubstr("beyond the degree of Diffuse"));
  for (const char* name : {"Diffuse-0.exr", "Diffuse-1.exr"}) fs::remove(temp / "set" / name);
  EXPECT_THAT(refusal(temp / "set"), HasSubstr("is no ST-BRDF set"));
  EXPECT_THAT(refusal(temp / "nowhere"), HasSubstr("cannot be read"));
}

TEST(StbrdfFile, RefusesSizesThatDifferAndValuesThatCannotBe) {
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  const auto planted = [&](Image<float> map, const std::string& file) {
    fs::remove_all(temp / "set");
    writeStbrdfSet(temp / "set", smallSet(2), progress);
    writeExr(temp / "set" / file, map.view());
    return refusal(temp / "set");
  };
  EXPECT_THAT(planted(Image<float>(4, 4, 1), "Specular-2.exr"),
              HasSubstr("Specular-2.exr is 4x4 with 1 channels, unlike the others (5x4, 1)"));
  Image<float> map(5, 4, 1);
  map.at(3, 1) = NAN;
  EXPECT_THAT(planted(map, "Specular-1.exr"),
              HasSubstr("Specular-1.exr holds a value that is no number at (3, 1)"));
  map.at(3, 1) = 30;
  EXPECT_THAT(planted(map, "Specular-2.exr"),
              HasSubstr("far outside [0.000000, 1.000000], at (3, 1)"));
}

TEST(StbrdfFile, RefusesAManifestThatCannotBe) {
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  writeStbrdfSet(temp / "set", smallSet(1), progress);
  const auto with = [&](const std::string& json) {
    patina::testing::writeFile(temp / "set/manifest.json", json);
    return refusal(temp / "set");
  };
  const std::string head = R"({"format":"patina.stbrdf-set/1","basis":"monomial",)";
  EXPECT_EQ(with(head + R"("degree":1,"maps":["Diffuse"]})"), "taken");
  EXPECT_THAT(with(head + R"("degree":13,"maps":["Diffuse"]})"), HasSubstr("degree is 13"));
  EXPECT_THAT(with(head + R"("maps":["Diffuse"]})"), HasSubstr("degree is -1"));
  EXPECT_THAT(with(head + R"("degree":1})"), HasSubstr("`maps`"));
  EXPECT_THAT(with(head + R"("degree":1,"maps":["../Diffuse"]})"), HasSubstr("no name of a map"));
  EXPECT_THAT(with(head + R"("degree":1,"maps":["Diffuse"],"ranges":[0]})"), HasSubstr("`ranges`"));
  EXPECT_THAT(with(R"({"format":"other"})"), HasSubstr("`format`"));
}

TEST(StbrdfFile, WritesNothingWhereItMayNot) {
  const TempFolder temp = TempFolder::inMemory();
  Progress progress;
  fs::create_directory(temp / "there");
  EXPECT_THROW(writeStbrdfSet(temp / "there", smallSet(1), progress), ProcessingError);
  StbrdfSet broken = smallSet(1);
  broken.maps[0].coefficients[1].at(0, 0) = INFINITY;
  EXPECT_THROW(writeStbrdfSet(temp / "broken", broken, progress), ProcessingError);
  progress.askToStop();
  EXPECT_THROW(writeStbrdfSet(temp / "stopped", smallSet(1), progress), Stopped);
  EXPECT_EQ(std::distance(fs::directory_iterator(temp.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace patina::stbrdf
