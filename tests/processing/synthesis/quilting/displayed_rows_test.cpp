// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/displayed_rows.h"

#include <gtest/gtest.h>

#include "processing/image/encoding.h"

namespace patina::quilting {
namespace {

constexpr int kTexels = 300, kStride = 310;

template <class T>
std::vector<T> ramp(int channels, int step) {
  std::vector<T> in;
  for (int i = 0; i < kTexels * channels; ++i) in.push_back(static_cast<T>(i * step));
  return in;
}

TEST(DisplayedRows, HoldTheCodesOfAChannelEach) {
  for (const int channels : {1, 3, 4}) {
    const std::vector<std::uint8_t> in = ramp<std::uint8_t>(channels, 7);
    std::vector<std::uint8_t> out(static_cast<std::size_t>(kStride) * channels, 1);
    std::vector<float> shown(out.size());
    spreadCodes(in.data(), kTexels, channels, out.data(), kStride);
    DisplayedRows(1.0, true).spread(in.data(), kTexels, channels, shown.data(), kStride);
    for (int c = 0; c < channels; ++c)
      for (int i = 0; i < kStride; ++i) {
        ASSERT_EQ(out[c * kStride + i], i < kTexels ? in[i * channels + c] : 1)
            << channels << " channels, " << i;
        if (i < kTexels) {
          ASSERT_NEAR(shown[c * kStride + i], out[c * kStride + i] * kCodeStep, 1e-6);
        }
      }
  }
}

TEST(DisplayedRows, ShowLightTimesItsScaleUpToWhite) {
  const std::vector<std::uint8_t> codes = ramp<std::uint8_t>(3, 7);
  const std::vector<std::uint16_t> linear = ramp<std::uint16_t>(3, 70);
  std::vector<float> of_codes(3 * kStride), of_linear(3 * kStride);
  DisplayedRows(2.0, true).spread(codes.data(), kTexels, 3, of_codes.data(), kStride);
  DisplayedRows(2.0, false).spread(linear.data(), kTexels, 3, of_linear.data(), kStride);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < kTexels; ++i) {
      const float code = codes[3 * i + c] / 255.0f, light = linear[3 * i + c] / 65535.0f;
      ASSERT_NEAR(of_codes[c * kStride + i],
                  srgbFromLinear(std::min(1.0f, 2 * linearFromSrgb(code))), 1e-5);
      ASSERT_NEAR(of_linear[c * kStride + i], srgbFromLinear(std::min(1.0f, 2 * light)), 1e-5);
    }
}

}  // namespace
}  // namespace patina::quilting
