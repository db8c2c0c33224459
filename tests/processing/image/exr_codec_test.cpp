// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/codecs.h"
#include "tests/processing/image/samples.h"
#include "tests/support/places.h"

namespace patina {
namespace {

Image<float> wild(int channels) {
  Image<float> out(21, 34, channels);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(gaussian(i) * 100);
  return out;
}

TEST(EncodeExr, KeepsFloatsOutsideZeroToOne) {
  for (int channels : {1, 3}) {
    const auto in = wild(channels);
    const Picture out = decodePicture(codecs::encodeExr(in.view()));
    EXPECT_EQ(out.linear.texels(), in.texels());
    EXPECT_EQ(out.bits, 32);
  }
}

TEST(DecodeExr, RefusesEveryTruncationAndSurvivesDamage) {
  const Bytes file = codecs::encodeExr(wild(3).view());
  for (int i = 1; i < 50; ++i) {
    const auto cut = std::span(file).first(file.size() * i / 50);
    EXPECT_THROW(decodePicture(cut), ProcessingError) << i;
  }
  EXPECT_GT(countRefusedDamage(file), 50);
}

TEST(DecodeExr, ReadsTheRealHalfFloatMaps) {
  PATINA_TEST_DATA_OR_SKIP(folder, "snowyground_stbrdf");
  const Picture diffuse = readPicture(folder / "Diffuse-0.exr");
  EXPECT_EQ(diffuse.linear.size(), (SizePx{512, 512}));
  EXPECT_EQ(diffuse.bits, 16);
}

}  // namespace
}  // namespace patina
