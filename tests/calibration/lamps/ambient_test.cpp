// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/ambient.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "tests/support/places.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kNoisePerLevel = 1 / 30000.0, kReadNoise = 1e-4;

// Light of `level` at exposure `times`, with the sensor's noise.
Image<float> exposed(double level, double times, std::uint64_t seed) {
  Image<float> picture(200, 150, 3);
  for (std::size_t k = 0; k < picture.texels().size(); ++k) {
    const double mean = level * times,
                 noise = std::sqrt(mean * kNoisePerLevel + kReadNoise * kReadNoise);
    picture.texels()[k] = static_cast<float>(mean + noise * gaussian(hashSeed(seed, k)));
  }
  return picture;
}

TEST(Ambient, IsTakenAwayScaledByExposureAndItsNoiseIsStated) {
  Image<float> frame = exposed(0.3 + 0.1, 1, 1);
  const Image<float> off = exposed(0.1, 0.5, 2);
  AmbientOptions options;
  options.exposure_ratio = 2;
  options.noise_per_level = kNoisePerLevel;
  options.read_noise = kReadNoise;
  const AmbientReport report = subtractAmbient(frame.view(), off.view(), options);
  double mean = 0, square = 0;
  for (const float v : frame.texels()) mean += v / static_cast<double>(frame.texels().size());
  for (const float v : frame.texels())
    square += (v - mean) * (v - mean) / static_cast<double>(frame.texels().size());
  EXPECT_NEAR(mean, 0.3, 1e-4);
  EXPECT_NEAR(report.share[1], 0.25, 1e-3);
  const double before = std::sqrt(0.4 * kNoisePerLevel + kReadNoise * kReadNoise);
  EXPECT_NEAR(report.noise_factor, std::sqrt(square) / before, 0.01);
  EXPECT_GT(report.noise_factor, 1.1);
}

TEST(Ambient, IsNotClampedSoThatTheMeanOfDarknessStaysTrue) {
  Image<float> frame = exposed(0.02, 1, 3);
  const Image<float> off = exposed(0.02, 1, 4);
  AmbientOptions options;
  options.share_most = 1;
  // Nothing but ambient light, give or take noise.
  for (float& v : frame.texels()) v += 1e-4f;
  subtractAmbient(frame.view(), off.view(), options);
  double mean = 0;
  for (const float v : frame.texels()) mean += v / static_cast<double>(frame.texels().size());
  EXPECT_NEAR(mean, 1e-4, 2e-5);
}

TEST(Ambient, IsRefusedWhenItCannotBeKnown) {
  Image<float> frame = exposed(0.4, 1, 1);
  const auto refuses = [&](const Image<float>& off, const char* why) {
    Image<float> copy = frame;
    EXPECT_THAT(([&] { subtractAmbient(copy.view(), off.view(), {}); }),
                ThrowsMessage<CalibrationError>(HasSubstr(why)));
    EXPECT_EQ(copy.texels(), frame.texels()) << "nothing was changed";
  };
  refuses(exposed(0.3, 1, 2), "% of the frame's light is ambient");
  refuses(Image<float>(20, 20, 3), "another size");
  Image<float> clipped = exposed(0.01, 1, 2);
  for (int x = 0; x < 100; ++x) clipped.at(x, 5) = 1;
  refuses(clipped, "clipped");
  AmbientOptions options;
  options.exposure_ratio = 0;
  EXPECT_THROW(options.check(), CalibrationError);
}

// Eight pictures by one LED each beside one by the room's light alone.
TEST(Ambient, OfARealRigLeavesDarknessWhereNoLedReaches) {
  PATINA_TEST_DATA_OR_SKIP(folder, "butterfly_leds");
  const Image<float> off = readPicture(folder / "image_ambient.png").linear;
  for (int i = 0; i < 8; ++i) {
    Image<float> frame = readPicture(folder / ("image" + std::to_string(i) + ".png")).linear;
    AmbientOptions options;
    options.share_most = 1;
    const AmbientReport report = subtractAmbient(frame.view(), off.view(), options);
    std::printf("LED %d: %.1f %% of its picture's light was ambient\n", i, 100 * report.share[0]);
    EXPECT_LT(report.share[0], 1);
  }
}

}  // namespace
}  // namespace patina::calibration
