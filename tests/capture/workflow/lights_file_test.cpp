// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lights_file.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/support/places.h"

namespace patina::workflow {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseLights(text, "dirs.lp");
  } catch (const WorkflowError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
    return error.what();
  }
  return "no error";
}

TEST(LightsFile, ReadsACountAndThenALineAPicture) {
  const auto lights = parseLights("2\na.jpg 0 0 1\nb.jpg 0.6 -0.5 0.8\n", "dirs.lp");
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[1].file, "b.jpg");
  EXPECT_DOUBLE_EQ(lights[1].direction[1], -0.5);
}

TEST(LightsFile, NamesTheLineOfWhatIsWrong) {
  EXPECT_THAT(errorOf("2\na.jpg 0 0 1\n"), ::testing::StartsWith("dirs.lp:1: says 2"));
  EXPECT_THAT(errorOf("1\na.jpg 0 zero 1\n"), ::testing::StartsWith("dirs.lp:2: "));
  EXPECT_THAT(errorOf("1\na.jpg 0 0 0\n"), ::testing::HasSubstr("no direction"));
  EXPECT_THAT(errorOf("2\na.jpg 0 0 1\na.jpg 0 0 1\n"), ::testing::HasSubstr("twice"));
  EXPECT_THAT(errorOf("a.jpg 0 0 1\n"), ::testing::HasSubstr("number of lights"));
  EXPECT_THAT(errorOf("1\na.jpg nan 0 1\n"), ::testing::StartsWith("dirs.lp:2: "));
  EXPECT_THAT(errorOf(""), ::testing::HasSubstr("dirs.lp:1: "));
}

TEST(LightsFile, IsWrittenSoThatItReadsTheSame) {
  const std::vector<LightDirection> lights{{"a.jpg", {0.6, -0.48, 0.64}}, {"key", {0, 0, 1}}};
  const std::string text = textOfLights(lights);
  EXPECT_EQ(text, "2\na.jpg 0.600000 -0.480000 0.640000\nkey 0.000000 0.000000 1.000000\n");
  const std::vector<LightDirection> back = parseLights(text, "dirs.lp");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].file, "a.jpg");
  EXPECT_DOUBLE_EQ(back[0].direction[1], -0.48);
}

TEST(LightsFile, DoesNotNameAPictureThatNobodyCouldReadBack) {
  EXPECT_THROW(textOfLights({{"two words.jpg", {0, 0, 1}}}), WorkflowError);
}

TEST(LightsFile, ReadsAMeasuredOne) {
  PATINA_TEST_DATA_OR_SKIP(file, "icon_rti/dirs.lp");
  const auto lights = readLights(file);
  ASSERT_EQ(lights.size(), 72u);
  for (const LightDirection& light : lights) EXPECT_GT(light.direction[2], 0) << light.file;
}

}  // namespace
}  // namespace patina::workflow
