// SPDX-License-Identifier: GPL-3.0-or-later
// Raw files of an even light, with the noise of a sensor of 7.44 electrons a number.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina::testing {

inline void plantRaw(const std::filesystem::path& file, double numbers, std::uint64_t seed,
                     SizePx size = {128, 128}) {
  std::filesystem::create_directories(file.parent_path());
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
  for (std::size_t i = 0; i < raw.samples.texels().size(); ++i)
    raw.samples.texels()[i] = static_cast<std::uint16_t>(
        std::lround(64 + numbers + std::sqrt(numbers / 7.44 + 0.16) * gaussian(hashSeed(seed, i))));
  raw.black_level = 64;
  raw.white_level = 4095;
  raw.exposure = std::chrono::milliseconds(20);
  raw.iso = Iso{100};
  writeFileAtomically(file, encodeDng(raw));
}

}  // namespace patina::testing
