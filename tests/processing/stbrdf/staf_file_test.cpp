// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "tests/processing/stbrdf/staf_samples.h"
#include "tests/support/temp_folder.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

StafSet fitted() {
  Progress progress;
  StafSet set;
  set.model = "ggx";
  set.roughness = "alpha";
  for (const auto& [name, channels] : {std::pair{"Diffuse", 3}, {"Specular", 1}, {"Roughness", 1}})
    set.maps.push_back(fitStaf(singleProcess(name, channels, 6, 12), {}, progress).map);
  return set;
}

// As the database has it: Kd rises from 0.2 to 0.6, 1 / sigma^2 from 4 to 16.
void plantDatabase(const fs::path& folder) {
  fs::create_directories(folder);
  const auto plant = [&](const std::string& name, float value, int channels) {
    writeExr(folder / ("tvBTF07-staf-" + name + ".exr"),
             Image<float>(4, 3, channels, value).view());
  };
  for (const std::string map : {"Kd", "Ks", "Sigma"}) {
    plant(map + "-A", map == "Kd" ? 0.4f : map == "Ks" ? 0.0f : 12.0f, map == "Kd" ? 3 : 1);
    plant(map + "-B", 2, map == "Kd" ? 3 : 1);
    plant(map + "-C", 0, map == "Kd" ? 3 : 1);
    plant(map + "-D", map == "Kd" ? 0.2f : map == "Ks" ? 1.0f : 4.0f, map == "Kd" ? 3 : 1);
  }
  patina::testing::writeFile(folder / "tvBTF07-staf-Kd-phi.txt",
                             "pphi_r: 7 0 0 0 0 0 2 0 \npphi_g: 0 0 0 0 0 2 0 \npphi_b: 2 0\n");
  patina::testing::writeFile(folder / "tvBTF07-staf-Ks-phi.txt",
                             " pphi_Ks: 0 0 0 0 0 2 0 \n pphi_S: 0 0 0 0 0 2 0 \n");
}

std::string refusal(const fs::path& folder) {
  try {
    readStafSet(folder);
  } catch (const ProcessingError& e) {
    return e.exit() == Exit::kBadData ? e.what() : "another exit code";
  }
  return "taken";
}

TEST(StafFile, GivesBackTheFunctionsThatWereWritten) {
  const TempFolder temp = TempFolder::inMemory();
  const StafSet set = fitted();
  writeStafSet(temp / "staf", set);
  const StafSet back = readStafSet(temp / "staf");
  EXPECT_FALSE(back.as_measured);
  EXPECT_EQ(back.model, "ggx");
  ASSERT_EQ(back.maps.size(), 3u);
  for (std::size_t m = 0; m < 3; ++m)
    for (const double t : {0.0, 0.4, 1.0}) {
      const Image<float> a = evaluate(set.maps[m], t, Clamp::kNone),
                         b = evaluate(back.maps[m], t, Clamp::kNone);
      for (std::size_t i = 0; i < a.texels().size(); ++i)
        ASSERT_NEAR(a.texels()[i], b.texels()[i], 2e-5);
    }
  Progress progress;
  const StbrdfSet polynomials = stafPolynomials(back, 3, progress);
  EXPECT_EQ(polynomials.degree, 6);
  EXPECT_THROW(writeStafSet(temp / "staf", set), ProcessingError);
}

TEST(StafFile, ReadsTheDatabasesFoldersAndUndoesTheirCoupling) {
  const TempFolder temp = TempFolder::inMemory();
  plantDatabase(temp / "sample");
  const StafSet set = readStafSet(temp / "sample");
  EXPECT_TRUE(set.as_measured);
  Progress progress;
  const StbrdfSet out = stafPolynomials(set, 5, progress);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(evaluate(out.maps[0], out.basis, 0.5, Clamp::kNone).at(1, 1, c), 0.4, 1e-5);
  // 1 / sigma^2 = 16 at the end: sigma = 1/4, and Ks times eq. 9's factor.
  EXPECT_NEAR(evaluate(out.maps[2], out.basis, 1, Clamp::kNone).at(0, 0), 0.25, 0.003);
  EXPECT_NEAR(evaluate(out.maps[1], out.basis, 1, Clamp::kNone).at(0, 0), M_PI / 16, 0.005);
}

TEST(StafFile, NamesWhatIsMissingOrCannotBeRead) {
  const TempFolder temp = TempFolder::inMemory();
  plantDatabase(temp / "sample");
  const fs::path curve = temp / "sample/tvBTF07-staf-Kd-phi.txt";
  patina::testing::writeFile(curve, "pphi_r: 1 x\n");
  EXPECT_THAT(refusal(temp / "sample"), HasSubstr("'x' after pphi_r: is no number"));
  patina::testing::writeFile(curve, "pphi_r: 1 2\npphi_b: 1 2\n");
  EXPECT_THAT(refusal(temp / "sample"), HasSubstr("has no line pphi_g:"));
  writeExr(temp / "sample/tvBTF07-staf-Kd-B.exr", Image<float>(4, 3, 3, 0.0f).view());
  EXPECT_THAT(refusal(temp / "sample"), HasSubstr("holds a 0"));
  writeExr(temp / "sample/tvBTF07-staf-Kd-B.exr", Image<float>(4, 4, 3, 1.0f).view());
  EXPECT_THAT(refusal(temp / "sample"), HasSubstr("differs in size"));
  fs::remove(temp / "sample/tvBTF07-staf-Kd-B.exr");
  EXPECT_THAT(refusal(temp / "sample"), HasSubstr("has no file *staf-Kd-B.exr"));
}

}  // namespace
}  // namespace patina::stbrdf
