// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/import_listing.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;
using testing::writeFile;
using namespace std::chrono_literals;

class ImportListing : public ::testing::Test {
 protected:
  void plant(const std::string& name) { writeFile(folder_ / name, name); }
  Listing list(TimesFrom times) {
    ListingOptions options;
    options.source = folder_.path();
    options.times = times;
    options.interval = 10min;
    options.start_utc = parseUtc("2024-05-01");
    return listSource(options);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(ImportListing, CountsStepsInNaturalOrder) {
  for (const char* name : {"b10.jpg", "b9.jpg", "b1.jpg", "LICENSE", "notes.txt"}) plant(name);
  const Listing listing = list(TimesFrom::kInterval);
  ASSERT_EQ(listing.steps.size(), 3u);
  EXPECT_EQ(listing.steps[1].shots[0].files[0].filename(), "b9.jpg");
  EXPECT_EQ(listing.steps[2].due_utc, parseUtc("2024-05-01") + 20min);
}

TEST_F(ImportListing, TakesRawAndJpegOfOneNameAsOneShot) {
  for (const char* name : {"a1.jpg", "a1.nef", "a2.jpg", "a2.NEF"}) plant(name);
  const Listing listing = list(TimesFrom::kInterval);
  ASSERT_EQ(listing.steps.size(), 2u);
  ASSERT_EQ(listing.steps[1].shots[0].files.size(), 2u);
  EXPECT_EQ(listing.steps[1].shots[0].files[0].filename(), "a2.NEF");
}

TEST_F(ImportListing, LeavesAMissedStepWhereANameIsMissing) {
  for (const char* day : {"01", "02", "04", "05"}) plant("2024-06-" + std::string(day) + ".jpg");
  plant("cover.jpg");
  const Listing listing = list(TimesFrom::kNames);
  EXPECT_EQ(listing.interval, 24h);
  ASSERT_EQ(listing.steps.size(), 5u);
  EXPECT_TRUE(listing.steps[2].shots.empty());
  EXPECT_EQ(listing.steps[2].due_utc, parseUtc("2024-06-03"));
  EXPECT_THAT(listing.without_time, ::testing::ElementsAre("cover.jpg"));
}

TEST_F(ImportListing, ChangesItsFingerprintWithTheSource) {
  plant("a1.jpg");
  const std::string one = list(TimesFrom::kInterval).fingerprint;
  EXPECT_EQ(list(TimesFrom::kInterval).fingerprint, one);
  plant("a2.jpg");
  EXPECT_NE(list(TimesFrom::kInterval).fingerprint, one);
}

TEST_F(ImportListing, MakesOneStepOfPicturesUnderKnownLights) {
  for (const char* name : {"a.jpg", "b.jpg"}) plant(name);
  writeFile(folder_ / "dirs.lp", "2\na.jpg 0 0 1\nb.jpg 1 0 1\n");
  ListingOptions options;
  options.source = folder_.path();
  options.lights = folder_ / "dirs.lp";
  const Listing listing = listSource(options);
  ASSERT_EQ(listing.steps.size(), 1u);
  ASSERT_EQ(listing.steps[0].shots.size(), 2u);
  EXPECT_EQ(listing.steps[0].shots[1].light, "b");
  EXPECT_EQ((*listing.lights[1].direction)[0], 1);
}

Exit exitOf(const ListingOptions& options) {
  try {
    listSource(options);
  } catch (const WorkflowError& error) {
    return error.exit();
  }
  return Exit::kOk;
}

TEST_F(ImportListing, SaysWhatItCannotUse) {
  ListingOptions options;
  options.source = folder_ / "not there";
  EXPECT_EQ(exitOf(options), Exit::kUsage);
  options.source = folder_.path();
  EXPECT_EQ(exitOf(options), Exit::kBadData);  // an empty folder
  plant("cover.jpg");
  options.times = TimesFrom::kNames;
  EXPECT_EQ(exitOf(options), Exit::kBadData);  // no name with a time
  plant("film.avi");
  options.source = folder_ / "film.avi";
  EXPECT_EQ(exitOf(options), Exit::kUsage);  // frames of a film have no names
}

TEST_F(ImportListing, ListsThePicturesOfAFolderAndNothingElse) {
  EXPECT_THROW((void)picturesIn(folder_.path()), WorkflowError);
  for (const char* name : {"b10.jpg", "b9.jpg", "notes.txt", "film.avi"}) plant(name);
  const std::vector<std::filesystem::path> files = picturesIn(folder_.path());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].filename(), "b9.jpg");
  EXPECT_EQ(files[1].filename(), "b10.jpg");
}

}  // namespace
}  // namespace patina::workflow
