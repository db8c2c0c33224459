// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/brdf_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "processing/image/picture_file.h"
#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace patina::brdf {
namespace {

using patina::testing::ImageNear;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

BrdfMaps smallMaps(float level = 0.25f) {
  BrdfMaps maps;
  maps.diffuse = Image<float>(5, 4, 3, level);
  maps.diffuse.at(2, 1, 1) = 0.7f;
  maps.specular = Image<float>(5, 4, 1, 0.04f);
  maps.roughness = Image<float>(5, 4, 1, 0.3f);
  maps.normal = Image<float>(5, 4, 3, 0.0f);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) maps.normal.at(x, y, 2) = 1;
  maps.extra["Confidence"] = Image<float>(5, 4, 1, 0.9f);
  return maps;
}

std::string refusal(const std::function<void()>& body, Exit exit) {
  try {
    body();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), exit) << e.what();
    return e.what();
  }
  return "(nothing was refused)";
}

TEST(BrdfFile, GivesBackEveryMapAndFact) {
  const TempFolder folder;
  BrdfSetInfo info;
  info.model = Model::kWard;
  info.facts.text("specimen", "copper").number("mm_per_texel", 0.2);
  writeBrdfSet(folder / "set", info, smallMaps());
  const BrdfSetInfo read = readBrdfSetInfo(folder / "set");
  EXPECT_EQ(read.model, Model::kWard);
  EXPECT_EQ(read.roughness, RoughnessKind::kAlpha);
  EXPECT_TRUE(read.times.empty());
  EXPECT_EQ(read.size, (SizePx{5, 4}));
  EXPECT_EQ(read.facts.text("specimen"), "copper");
  const BrdfMaps maps = readBrdfMaps(folder / "set", read), want = smallMaps();
  EXPECT_THAT(maps.diffuse, ImageNear(want.diffuse, 0));
  EXPECT_THAT(maps.specular, ImageNear(want.specular, 0));
  EXPECT_THAT(maps.roughness, ImageNear(want.roughness, 0));
  EXPECT_THAT(maps.normal, ImageNear(want.normal, 0));
  EXPECT_THAT(maps.extra.at("Confidence"), ImageNear(want.extra.at("Confidence"), 0));
}

TEST(BrdfFile, HoldsOneFolderATimeAndFindsTheNearest) {
  const TempFolder folder;
  BrdfSetInfo info;
  info.times = {0, 0.4, 1};
  const auto set = folder / "set";
  writeBrdfStep(set, info, 2, smallMaps(0.9f));
  EXPECT_FALSE(brdfStepIsThere(set, 0));
  EXPECT_TRUE(brdfStepIsThere(set, 2));
  EXPECT_THAT(refusal([&] { finishBrdfSet(set, info); }, Exit::kUsage), HasSubstr("t0000"));
  writeBrdfStep(set, info, 0, smallMaps(0.1f));
  writeBrdfStep(set, info, 1, smallMaps(0.5f));
  writeBrdfStep(set, info, 1, smallMaps(0.6f));  // once more, after a stop
  finishBrdfSet(set, info);
  const BrdfSetInfo read = readBrdfSetInfo(set);
  EXPECT_EQ(read.steps(), 3);
  EXPECT_EQ(nearestStep(read, 0.69), 1);
  EXPECT_EQ(nearestStep(read, 0.71), 2);
  EXPECT_FLOAT_EQ(readBrdfMaps(set, read, 1).diffuse.at(0, 0), 0.6f);
  EXPECT_EQ(readBrdfSetInfo(brdfStepFolder(set, 2)).facts.number("time"), 1);
}

TEST(BrdfFile, NeverWritesOverAnotherSet) {
  const TempFolder folder;
  writeBrdfSet(folder / "set", {}, smallMaps());
  EXPECT_THAT(refusal([&] { writeBrdfSet(folder / "set", {}, smallMaps()); }, Exit::kCannotCreate),
              HasSubstr("is there already"));
}

TEST(BrdfFile, WritesNothingOfASetThatItWouldNotRead) {
  const TempFolder folder;
  const auto refused = [&](const std::function<void(BrdfMaps&)>& spoil) {
    BrdfMaps maps = smallMaps();
    spoil(maps);
    return refusal([&] { writeBrdfSet(folder / "set", {}, maps); }, Exit::kUsage);
  };
  EXPECT_THAT(refused([](BrdfMaps& m) { m.diffuse.at(3, 2) = std::nanf(""); }),
              HasSubstr("Diffuse holds nan at (3, 2)"));
  EXPECT_THAT(refused([](BrdfMaps& m) { m.specular.at(0, 0) = -0.1f; }), HasSubstr("Specular"));
  EXPECT_THAT(refused([](BrdfMaps& m) { m.roughness.at(0, 0) = 1.5f; }), HasSubstr("Roughness"));
  EXPECT_THAT(refused([](BrdfMaps& m) { m.normal.at(1, 1, 2) = 0; }), HasSubstr("length 0"));
  EXPECT_THAT(refused([](BrdfMaps& m) { m.roughness = {}; }), HasSubstr("Roughness is missing"));
  EXPECT_THAT(refused([](BrdfMaps& m) { m.specular = Image<float>(4, 4, 1); }),
              HasSubstr("4x4, Diffuse 5x4"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(BrdfFile, RefusesFoldersThatAreNoSets) {
  const TempFolder folder;
  const auto set = folder / "set";
  writeBrdfSet(set, {}, smallMaps());
  const auto spoiled = [&](const std::string& manifest) {
    patina::testing::writeFile(set / "manifest.json", manifest);
    return refusal([&] { readBrdfSetInfo(set); }, Exit::kBadData);
  };
  EXPECT_THAT(spoiled("{}"), HasSubstr("no BRDF set"));
  EXPECT_THAT(spoiled(R"({"format":"patina.brdf-set/1","model":"phong"})"), HasSubstr("phong"));
  EXPECT_THAT(spoiled(R"({"format":"patina.brdf-set/1","model":"ggx","roughness":"shiny"})"),
              HasSubstr("shiny"));
  EXPECT_THAT(spoiled(R"({"format":"patina.brdf-set/1","model":"ggx","times":[1,0]})"),
              HasSubstr("do not rise"));
  EXPECT_THAT(spoiled(R"({"format":"patina.brdf-set/1","model":"ggx","times":[0,1]})"),
              HasSubstr("t0000"));
}

TEST(BrdfFile, NamesTheMapThatIsMissingOrDamaged) {
  const TempFolder folder;
  const auto set = folder / "set";
  writeBrdfSet(set, {}, smallMaps());
  const BrdfSetInfo info = readBrdfSetInfo(set);
  const auto read = [&] { readBrdfMaps(set, info); };
  writeExr(set / "Specular.exr", Image<float>(3, 3, 1, 0.0f).view());
  EXPECT_THAT(refusal(read, Exit::kBadData), HasSubstr("Specular is 3x3"));
  std::filesystem::remove(set / "Specular.exr");
  EXPECT_THAT(refusal(read, Exit::kBadData), HasSubstr("Specular is missing"));
  patina::testing::writeFile(set / "Specular.exr", "no picture");
  EXPECT_THAT(refusal(read, Exit::kBadData), HasSubstr("Specular.exr"));
}

TEST(BrdfFile, ALambertSetNeedsNoGloss) {
  const TempFolder folder;
  BrdfMaps maps;
  maps.diffuse = Image<float>(2, 2, 3, 0.5f);
  BrdfSetInfo info;
  info.model = Model::kLambert;
  writeBrdfSet(folder / "set", info, maps);
  EXPECT_TRUE(readBrdfMaps(folder / "set", readBrdfSetInfo(folder / "set")).specular.empty());
}

TEST(BrdfFile, NamesOfModelsAndRoughnessesComeBack) {
  for (const char* name : {"lambert", "ward", "ward-anisotropic", "torrance-sparrow", "ggx"})
    EXPECT_EQ(nameOf(modelOf(name)), name);
  for (const char* name : {"alpha", "perceptual", "sigma"})
    EXPECT_EQ(nameOf(roughnessKindOf(name)), name);
}

}  // namespace
}  // namespace patina::brdf
