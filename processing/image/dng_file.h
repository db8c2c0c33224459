// SPDX-License-Identifier: GPL-3.0-or-later
// DNG 1.4 out and raw in (LibRaw): one plane of Bayer samples, black and white known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processing/image/picture_file.h"

namespace patina {

struct RawMosaic {
  Image<std::uint16_t> samples;                 // [h][w][1]
  std::array<std::uint8_t, 4> cfa{0, 1, 1, 2};  // of the 2x2 cell, row by row; 0 R, 1 G, 2 B
  double black_level = 0, white_level = 65535;  // in samples
  std::optional<Nanoseconds> exposure;
  std::optional<Iso> iso;
  std::optional<FNumber> f_number;
  std::optional<UtcTime> taken_utc;
  std::string make, model;
  std::string serial;  // of the body; read back from our own files alone
};

// 16 bits a sample, uncompressed; LibRaw reads every value back. Pure: no clock, no file.
Bytes encodeDng(const RawMosaic& raw);
// LibRaw; throws ProcessingError(kBadData). No white balance, no gamma, no automatic brightness.
RawMosaic decodeRaw(std::span<const std::byte> file, const PictureLimits& = {});
// (sample - black) / (white - black), bilinear demosaic: [h][w][3] linear. Not clamped below 0.
Image<float> demosaic(const RawMosaic& raw);
// encodeSrgb8(demosaic(raw)), bit for bit, by a table of the levels: for one camera's many
// pictures. Immutable after construction. A raw file of other levels is a bug.
class SrgbDeveloper {
 public:
  SrgbDeveloper(double black_level, double white_level);
  Image<std::uint8_t> operator()(const RawMosaic& raw) const;  // [h][w][3]

 private:
  double black_level_, white_level_;
  std::vector<std::uint8_t> codes_;  // by quarters of a sample
};
// demosaic() without interpolation: each 2x2 cell gives one RGB texel: [h/2][w/2][3].
Image<float> demosaicHalf(const RawMosaic& raw);

}  // namespace patina
