// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/kept_samples.h"

namespace patina {

Image<std::uint16_t> unpackFullScale(const PackedPixels& packed) {
  Image<std::uint16_t> samples = unpackSamples(packed);
  const std::uint32_t white = (1u << packed.bits) - 1;
  for (std::uint16_t& v : samples.texels())
    v = static_cast<std::uint16_t>((v * 65535u + white / 2) / white);
  return samples;
}

RawMosaic unpackMosaic(const PackedPixels& packed, const std::array<std::uint8_t, 4>& cfa,
                       double black_level) {
  RawMosaic raw;
  raw.samples = unpackSamples(packed);
  raw.cfa = cfa;
  raw.black_level = black_level;
  raw.white_level = (1 << packed.bits) - 1;
  return raw;
}

}  // namespace patina
