// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/capture/app/raw_pictures.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class CalibrateDefects : public Rehearsed {};

TEST_F(CalibrateDefects, CountsWhatTheDarkOfTheArchiveShows) {
  EXPECT_EQ(patina({"calibrate", "defects", "--camera", "nobody"}).exit, 65);
  for (int i = 0; i < 3; ++i)
    plantRaw(place("flats/" + std::to_string(i) + ".dng"), 2000, static_cast<std::uint64_t>(i));
  answer({"calibrate", "flat", place("flats"), "--camera", "cam0"});
  const JsonAnswer found = answer({"calibrate", "defects", "--camera", "cam0"});
  EXPECT_EQ(found.number("/items/0/hot"), 0);
  EXPECT_EQ(found.number("/items/0/dead"), 0);
  EXPECT_TRUE(std::filesystem::exists(found.text("/items/0/path")));
}

}  // namespace
}  // namespace patina::testing
