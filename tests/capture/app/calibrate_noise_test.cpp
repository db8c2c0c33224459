// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/capture/app/raw_pictures.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class CalibrateNoise : public Rehearsed {};

TEST_F(CalibrateNoise, MeasuresFoldersAndKeepsTheModel) {
  for (int i = 0; i < 6; ++i) {
    const int pair = i / 2;
    plantRaw(place("flats/" + std::to_string(i) + ".dng"), 300 + 1000.0 * pair,
             static_cast<std::uint64_t>(i));
  }
  for (int i = 0; i < 2; ++i)
    plantRaw(place("closed/" + std::to_string(i) + ".dng"), 0, 10 + static_cast<std::uint64_t>(i));
  const JsonAnswer noise = answer(
      {"calibrate", "noise", place("flats"), "--darks", place("closed"), "--camera", "cam0"});
  ASSERT_EQ(noise.size("/items"), 3u);
  EXPECT_NEAR(noise.number("/items/1/electrons_per_number"), 7.44, 0.4);
  EXPECT_NEAR(noise.number("/items/1/read_noise_e"), 0.4 * 7.44, 0.3);
  EXPECT_EQ(patina({"calibrate", "noise", place("flats"), "--camera", "cam0"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
