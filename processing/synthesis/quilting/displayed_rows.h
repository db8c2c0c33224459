// SPDX-License-Identifier: GPL-3.0-or-later
// Samples as a file holds them, texel by texel, to rows of values as displayed, one a channel.
#pragma once

#include <cstdint>
#include <vector>

namespace patina::quilting {

class DisplayedRows {
 public:
  // Of samples of 16 bits, linear, of which 65535 means `scale`; or of 8 bits, sRGB codes of
  // values / scale.
  DisplayedRows(double scale, bool coded);

  // `count` texels [texel][channel] to rows [channel][texel], `stride` apart.
  void spread(const std::uint16_t* in, std::int64_t count, int channels, float* out,
              std::int64_t stride) const;
  void spread(const std::uint8_t* in, std::int64_t count, int channels, float* out,
              std::int64_t stride) const;

 private:
  std::vector<float> display_;  // of a sample
};

// Codes as they are, which are shown as so many steps where they are of values as such: scale 1.
void spreadCodes(const std::uint8_t* in, std::int64_t count, int channels, std::uint8_t* out,
                 std::int64_t stride);
inline constexpr float kCodeStep = 1 / 255.0f;

// Of linear samples of 16 bits, what is displayed, 0 to 1; [65536].
std::vector<float> displayTable(double scale);

}  // namespace patina::quilting
