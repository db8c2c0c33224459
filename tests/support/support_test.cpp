// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <signal.h>

#include <cmath>
#include <cstdlib>

#include "devices/result.h"
#include "tests/support/child.h"
#include "tests/support/golden.h"
#include "tests/support/matchers.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace fs = std::filesystem;

namespace patina::testing {
namespace {

using devices::Errc;
using devices::Result;
using ::testing::HasSubstr;
using ::testing::Not;

template <class T, class M>
std::string explain(const T& value, const M& matcher) {
  ::testing::StringMatchResultListener why;
  ::testing::Matcher<const T&>(matcher).MatchAndExplain(value, &why);
  return why.str();
}

TEST(IsOk, TellsTheErrorOfAFailedResult) {
  const Result<int> good = 3;
  const Result<int> bad = devices::fail(Errc::kBusy, "twin 'cam0': busy");
  EXPECT_THAT(good, IsOk());
  EXPECT_THAT(bad, Not(IsOk()));
  EXPECT_THAT(explain(bad, IsOk()), HasSubstr("twin 'cam0': busy"));
}

TEST(Fails, AcceptsOnlyTheCodeItNames) {
  const Result<int> bad = devices::fail(Errc::kBusy, "busy");
  EXPECT_THAT(bad, Fails(Errc::kBusy));
  EXPECT_THAT(bad, Not(Fails(Errc::kLost)));
  EXPECT_THAT(Result<int>(3), Not(Fails(Errc::kBusy)));
}

TEST(ImageNear, NamesTheWorstTexel) {
  const Image<float> want(4, 3, 2, 0.5f);
  Image<float> got = want;
  EXPECT_THAT(got, ImageNear(want, 0.0));
  got.at(1, 2, 1) = 0.6f;
  got.at(3, 0, 0) = 0.9f;
  EXPECT_THAT(got, ImageNear(want, 0.5));
  EXPECT_THAT(got, Not(ImageNear(want, 0.05)));
  EXPECT_THAT(explain(got, ImageNear(want, 0.05)), HasSubstr("2 values"));
  EXPECT_THAT(explain(got, ImageNear(want, 0.05)), HasSubstr("(3, 0, channel 0)"));
}

TEST(ImageNear, RejectsNanAndAnotherShape) {
  const Image<float> want(2, 2, 1, 0.5f);
  Image<float> got = want;
  got.at(1, 1) = std::nanf("");
  EXPECT_THAT(got, Not(ImageNear(want, 1e9)));
  EXPECT_THAT(Image<float>(2, 1, 1, 0.5f), Not(ImageNear(want, 1e9)));
}

TEST(TempFolder, IsUniqueAndGoneAfterwards) {
  fs::path path;
  {
    const TempFolder a, b;
    const TempFolder c = TempFolder::inMemory();
    path = a.path();
    EXPECT_NE(a.path(), b.path());
    fs::create_directories(a / "deep/er");
    writeFile(a / "deep/er/file", std::string("x\0y", 3));
    EXPECT_EQ(readFile(a / "deep/er/file"), std::string("x\0y", 3));
    fs::permissions(a / "deep", fs::perms::owner_read);
    EXPECT_TRUE(fs::exists(c.path()));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(Golden, RejectsAnotherTextAndAnotherImage) {
  EXPECT_TRUE(matchesGolden("support.txt", "first\nsecond\n"));
  Image<float> image(3, 2, 3, 0.25f);
  image.at(2, 1, 0) = 0.75f;
  EXPECT_TRUE(matchesGolden("support.pfm", image.view(), 0.0));
  if (std::getenv("PATINA_UPDATE_GOLDEN") != nullptr) return;
  EXPECT_THAT(matchesGolden("support.txt", "first\nother\n").message(), HasSubstr(":2:"));
  EXPECT_FALSE(matchesGolden("support.txt", "first\nsecond\nthird\n"));
  EXPECT_FALSE(matchesGolden("support.txt", "first\n"));
  image.at(0, 0, 1) = 0.5f;
  EXPECT_FALSE(matchesGolden("support.pfm", image.view(), 0.2));
  EXPECT_TRUE(matchesGolden("support.pfm", image.view(), 0.3));
  EXPECT_FALSE(matchesGolden("nowhere.txt", ""));
}

TEST(Child, TellsOutputExitAndSignal) {
  const Finished done =
      run({"/bin/sh", "-c", "echo out; echo $PATINA_X >&2; exit 7"}, {"PATINA_X=err"});
  EXPECT_EQ(done.exit, 7);
  EXPECT_EQ(done.out, "out\n");
  EXPECT_EQ(done.err, "err\n");
  Child child({"/bin/sh", "-c", "while :; do :; done"});
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait().signal, SIGTERM);
}

TEST(Places, FindTheTopOfTheTree) {
  EXPECT_TRUE(fs::exists(sourceFolder() / "tests/support/places.h"));
}

}  // namespace
}  // namespace patina::testing
