// SPDX-License-Identifier: GPL-3.0-or-later
// Small volumes whose every sample is known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "processing/image/random.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {

struct Shape {
  int frames, height, width, channels;
};

inline Image<std::uint16_t> sampleFrame(const Shape& s, int t) {
  Image<std::uint16_t> frame(s.width, s.height, s.channels);
  for (int y = 0; y < s.height; ++y)
    for (int x = 0; x < s.width; ++x)
      for (int c = 0; c < s.channels; ++c)
        frame.at(x, y, c) = static_cast<std::uint16_t>(hashSeed(7, t, y, x, c));
  return frame;
}

inline Sha256 sourceHash(int t) { return sha256("frame " + std::to_string(t)); }

inline TtfInfo infoOf(const Shape& s, SampleType type = SampleType::kU16) {
  TtfInfo info;
  info.height = s.height;
  info.width = s.width;
  info.channels = s.channels;
  info.type = type;
  info.mm_per_texel = 0.25;
  info.t0_utc = parseUtc("2024-05-01T12:00:00Z");
  info.provenance_json = R"({"command":"test"})";
  return info;
}

inline void writeVolume(const std::filesystem::path& path, const Shape& s,
                        SampleType type = SampleType::kU16, bool compress = false) {
  TtfWriter writer(path, infoOf(s, type), compress);
  for (int t = 0; t < s.frames; ++t) {
    const Image<std::uint16_t> frame = sampleFrame(s, t);
    writer.add(frame.view(), 600.0 * t, sourceHash(t));
  }
  writer.close();
}

}  // namespace patina::ttf
