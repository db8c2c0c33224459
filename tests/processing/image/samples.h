// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures, and the ways a file goes bad.
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina {

// Smooth, coloured, no two rows alike; values 20 to 220.
inline Image<std::uint8_t> gradient(int width, int height, int channels) {
  Image<std::uint8_t> out(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        out.at(x, y, c) =
            static_cast<std::uint8_t>(20 + (100 * x) / width + (c == 1 ? 60 : 100) * y / height);
  return out;
}

inline RawMosaic mosaic(int width, int height) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      raw.samples.at(x, y) = static_cast<std::uint16_t>(64 + uniformBelow(hashSeed(1, x, y), 4000));
  raw.black_level = 64;
  raw.white_level = 4095;
  raw.exposure = Nanoseconds{16'666'667};
  raw.iso = Iso{200};
  raw.f_number = FNumber{5.6};
  raw.taken_utc = utcFromNs(1'714'564'800'123'456'789);
  raw.make = "Patina";
  raw.model = "Twin";
  return raw;
}

// The message of the ProcessingError(kBadData) that `body` must throw.
template <class Body>
std::string refusalOf(const Body& body) {
  try {
    body();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kBadData) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

// Every cut and many flipped bytes: a picture or a ProcessingError, never anything else.
inline int countRefusedDamage(const Bytes& good) {
  int refused = 0;
  const auto attempt = [&](std::span<const std::byte> file) {
    try {
      const Picture picture = decodePicture(file, {.pixels_max = 10'000'000});
      EXPECT_FALSE(picture.linear.empty());
    } catch (const ProcessingError&) {
      ++refused;
    }
  };
  for (int i = 0; i < 50; ++i) attempt(std::span(good).first(good.size() * i / 50));
  for (std::uint64_t i = 0; i < 400; ++i) {
    Bytes bad = good;
    // Half of the flips hit the first 200 bytes, where the claims are.
    const std::size_t reach = i % 2 ? good.size() : std::min<std::size_t>(200, good.size());
    bad[uniformBelow(hashSeed(7, i), reach)] ^= static_cast<std::byte>(1 + hashSeed(8, i) % 255);
    attempt(bad);
  }
  return refused;
}

inline Bytes bytesOf(std::string_view text) {
  const auto view = std::as_bytes(std::span(text.data(), text.size()));
  return {view.begin(), view.end()};
}

}  // namespace patina
