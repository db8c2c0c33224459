// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/linear_mosaic.h"

#include <gtest/gtest.h>

#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina {
namespace {

TEST(DemosaicLinear, IsThatOfTheRawFileForEveryOrderOfFiltersAndSize) {
  for (const std::array<std::uint8_t, 4> cfa : {std::array<std::uint8_t, 4>{0, 1, 1, 2},
                                                {2, 1, 1, 0},
                                                {1, 0, 2, 1},
                                                {1, 2, 0, 1},
                                                {0, 0, 1, 2}})
    for (const SizePx size : {SizePx{17, 12}, {2, 2}, {1, 5}, {40, 1}}) {
      RawMosaic raw;
      raw.cfa = cfa;
      raw.black_level = 64;
      raw.white_level = 4095;
      raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
      Image<float> linear(size.width, size.height, 1);
      for (std::size_t i = 0; i < linear.texels().size(); ++i) {
        raw.samples.texels()[i] = static_cast<std::uint16_t>(hashSeed(1, i) % 4096);
        linear.texels()[i] = (static_cast<float>(raw.samples.texels()[i]) - 64) / 4031;
      }
      const Image<float> wanted = demosaic(raw);
      const Image<float> got = demosaicLinear(std::as_const(linear).view(), cfa);
      for (std::size_t i = 0; i < wanted.texels().size(); ++i) {
        // A colour that no filter near the border has is 0 here and black there.
        if (wanted.texels()[i] == 0) continue;
        ASSERT_NEAR(got.texels()[i], wanted.texels()[i], 1e-6) << size.width << " at " << i;
      }
    }
}

}  // namespace
}  // namespace patina
