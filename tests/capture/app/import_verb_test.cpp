// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class ImportVerb : public ::testing::Test {
 protected:
  Finished patina(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--archive", archive_});
    return runPatina(std::move(arguments));
  }
  JsonAnswer answer(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return answerOf(patina(std::move(arguments)));
  }
  std::string place(const std::string& name) { return folder_ / name; }
  TempFolder folder_ = TempFolder::inMemory();
  const std::string archive_ = folder_ / "archive";
};

TEST_F(ImportVerb, BringsAGifToFilmSheetAndQuilt) {
  PATINA_TEST_DATA_OR_SKIP(gif, "ivy_timelapse/timelapse.gif");
  const JsonAnswer run = answer({"import", gif, "--specimen", "ivy", "--interval", "1h"});
  EXPECT_EQ(run.number("/items/0/frames"), 30);
  EXPECT_THAT(run.text("/items/0/run_id"), ::testing::EndsWith("-ivy"));
  const JsonAnswer built = answer({"ttf", "build", "--run", "latest", "--out", place("ivy.h5")});
  EXPECT_EQ(built.number("/items/0/width_px"), 300);
  EXPECT_EQ(built.number("/items/0/frames"), 30);
  answer({"film", place("ivy.h5"), place("ivy.mp4")});
  answer({"sheet", place("ivy.h5"), place("ivy.png")});
  const JsonAnswer quilt =
      answer({"synth", "quilt", place("ivy.h5"), "--size", "600x960", "--out", place("q.h5")});
  EXPECT_EQ(quilt.number("/items/0/frames"), 30);
  EXPECT_EQ(answer({"ttf", "info", place("q.h5")}).number("/items/0/height_px"), 960);
  for (const char* name : {"ivy.mp4", "ivy.png"}) EXPECT_GT(readFile(place(name)).size(), 10'000u);
}

TEST_F(ImportVerb, HasADayThatIsMissingAsAMissedStep) {
  PATINA_TEST_DATA_OR_SKIP(rosette, "arabidopsis_timelapse/rosette_11");
  std::filesystem::copy(rosette, folder_ / "rosette");
  std::filesystem::permissions(folder_ / "rosette", std::filesystem::perms::owner_all);
  std::filesystem::remove(folder_ / "rosette/2019-10-26-11-05.jpg");
  const JsonAnswer run =
      answer({"import", place("rosette"), "--specimen", "rosette", "--times", "names"});
  EXPECT_EQ(run.number("/items/0/captured"), 10);
  EXPECT_EQ(run.number("/items/0/missed"), 1);
  EXPECT_EQ(run.number("/items/0/interval_ns"), 86'400e9);
  EXPECT_GT(run.number("/items/0/sizes"), 1);
  const JsonAnswer missed = answer({"archive", "query", "--decision", "missed"});
  EXPECT_EQ(missed.number("/items/0/number"), 4);
  const JsonAnswer built = answer({"ttf", "build", "--out", place("r.h5")});
  EXPECT_EQ(built.number("/items/0/frames"), 10);
  EXPECT_EQ(built.number("/items/0/width_px"), 499);
  EXPECT_EQ(patina({"archive", "verify"}).exit, 0);
}

TEST_F(ImportVerb, CountsTheFramesOfAFilmByDecodingThem) {
  PATINA_TEST_DATA_OR_SKIP(tree, "dynamic_texture/tree.avi");
  const JsonAnswer run =
      answer({"import", tree, "--specimen", "tree", "--interval", "40ms", "--start", "2020-01-01"});
  EXPECT_EQ(run.number("/items/0/frames"), 68);
  EXPECT_EQ(run.text("/items/0/run_id"), "20200101T000000Z-tree");
}

TEST_F(ImportVerb, MakesOneStepOfPicturesUnderKnownLights) {
  PATINA_TEST_DATA_OR_SKIP(icon, "icon_rti");
  const JsonAnswer run =
      answer({"import", icon, "--specimen", "icon", "--lights", icon / "dirs.lp"});
  EXPECT_EQ(run.number("/items/0/steps"), 1);
  EXPECT_EQ(run.number("/items/0/frames"), 72);
  EXPECT_EQ(patina({"ttf", "build", "--out", place("x.h5")}).exit, 64);
  answer({"ttf", "build", "--light", "image07", "--out", place("x.h5")});
}

TEST_F(ImportVerb, AsksForATime) {
  const Finished finished = patina({"import", place("."), "--specimen", "x"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("--interval"));
  EXPECT_EQ(patina({"import", place("."), "--interval", "1h"}).exit, 64);  // no specimen
  EXPECT_EQ(patina({"import", place("."), "--specimen", "x", "--times", "guess"}).exit, 64);
}

TEST_F(ImportVerb, IsBadDataOnlyWhenNothingWasUsable) {
  std::filesystem::create_directories(place("pictures"));
  writeFile(place("pictures/a.jpg"), "not a picture");
  const std::vector<std::string> command = {
      "import", place("pictures"), "--specimen", "x", "--interval", "1h", "--json"};
  const Finished nothing = patina(command);
  EXPECT_EQ(nothing.exit, 65);
  EXPECT_EQ(JsonAnswer(nothing.err.substr(nothing.err.rfind("{\"error\""))).number("/error/exit"),
            65);
  writePng(place("pictures/b.png"), Image<std::uint8_t>(8, 8, 3, 99).view());
  const JsonAnswer run = answerOf(patina(command));
  EXPECT_EQ(run.number("/items/0/captured"), 1);
  EXPECT_EQ(run.number("/items/0/warnings"), 1);
  EXPECT_EQ(run.text("/items/0/quarantined/0"), "a.jpg");
}

}  // namespace
}  // namespace patina::testing
