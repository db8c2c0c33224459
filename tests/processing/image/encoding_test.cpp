// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/encoding.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "processing/image/random.h"

namespace patina {
namespace {

TEST(Srgb, GivesTheValuesOfTheStandard) {
  EXPECT_NEAR(srgbFromLinear(0.0031308f), 0.0404499f, 1e-6);
  EXPECT_NEAR(srgbFromLinear(0.5f), 0.735357f, 1e-6);
  EXPECT_NEAR(linearFromSrgb(0.5f), 0.214041f, 1e-6);
  EXPECT_EQ(srgbFromLinear(-1), 0);
  EXPECT_EQ(srgbFromLinear(2), 1);
  EXPECT_EQ(srgbFromLinear(std::nanf("")), 0);
}

TEST(EncodeSrgb8, RoundsExactlyEvenAtEveryThreshold) {
  Image<float> in(256 * 8, 1, 1);
  for (int i = 0; i < in.width(); ++i) {
    // Just below and just above each step between two codes, and values between.
    const int code = i / 8;
    const float step = linearFromSrgb((static_cast<float>(code) + 0.5f) / 255.0f);
    const float spread[] = {0.98f, 0.999f, 0.9999f, 1.0001f, 1.001f, 1.02f, 1.1f, 0.9f};
    in.at(i, 0) = step * spread[i % 8];
  }
  const auto out = encodeSrgb8(std::as_const(in).view());
  for (int i = 0; i < in.width(); ++i)
    EXPECT_EQ(out.at(i, 0), std::lround(srgbFromLinear(in.at(i, 0)) * 255.0f)) << in.at(i, 0);
}

TEST(EncodeSrgb8, ClampsAndTakesNanAsBlack) {
  Image<float> in(4, 1, 1);
  in.at(0, 0) = -0.5f;
  in.at(1, 0) = 7;
  in.at(2, 0) = std::numeric_limits<float>::quiet_NaN();
  in.at(3, 0) = std::numeric_limits<float>::infinity();
  const auto out = encodeSrgb8(std::as_const(in).view());
  EXPECT_EQ(out.texels(), (std::vector<std::uint8_t>{0, 255, 0, 255}));
  const auto codes = quantize16(std::as_const(in).view());
  EXPECT_EQ(codes.texels(), (std::vector<std::uint16_t>{0, 65535, 0, 65535}));
}

TEST(DecodeSrgb, ComesBackToEveryCode) {
  Image<std::uint8_t> codes(256, 1, 1);
  for (int i = 0; i < 256; ++i) codes.at(i, 0) = static_cast<std::uint8_t>(i);
  const auto linear = decodeSrgb(std::as_const(codes).view());
  EXPECT_EQ(encodeSrgb8(linear.view()).texels(), codes.texels());
  EXPECT_EQ(linear.at(0, 0), 0);
  EXPECT_EQ(linear.at(255, 0), 1);
  const auto linear16 = quantize16(linear.view());
  const auto again = encodeSrgb8(linear16.view());
  for (int i = 40; i < 256; ++i) EXPECT_EQ(again.at(i, 0), i);
}

TEST(DecodeSrgb, Of16BitsAgreesWith8) {
  Image<std::uint8_t> low(256, 1, 1);
  Image<std::uint16_t> high(256, 1, 1);
  for (int i = 0; i < 256; ++i) {
    low.at(i, 0) = static_cast<std::uint8_t>(i);
    high.at(i, 0) = static_cast<std::uint16_t>(i * 257);
  }
  const auto a = decodeSrgb(std::as_const(low).view()), b = decodeSrgb(std::as_const(high).view());
  for (int i = 0; i < 256; ++i) EXPECT_FLOAT_EQ(a.at(i, 0), b.at(i, 0));
}

TEST(EncodeSrgb8, IsTheSameOnOneThreadAndReadsOnlyItsView) {
  Image<float> in(700, 300, 3);
  for (std::size_t i = 0; i < in.texels().size(); ++i)
    in.texels()[i] = static_cast<float>(uniform(hashSeed(1, i)));
  const auto view = std::as_const(in).view().crop({10, 20, 333, 77});
  const auto many = encodeSrgb8(view);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(encodeSrgb8(view).texels(), many.texels());
  EXPECT_EQ(many.at(5, 6, 1), std::lround(srgbFromLinear(in.at(15, 26, 1)) * 255.0f));
}

}  // namespace
}  // namespace patina
