// SPDX-License-Identifier: GPL-3.0-or-later
// From a mosaic of colour filters to three channels, for dng_file.h.
#include <array>

#include "processing/image/dng_file.h"
#include "processing/image/parallel_rows.h"

namespace patina {
namespace {

struct Offset {
  std::int8_t dx, dy;
};

// The samples of one colour within the 3x3 window around a position of the 2x2 cell. At the
// position of the colour itself only that sample counts.
struct Neighbours {
  std::array<Offset, 9> offsets;
  int count = 0;
};

Neighbours neighboursOf(const RawMosaic& raw, int cell_x, int cell_y, int colour) {
  Neighbours out;
  const auto colourAt = [&](int x, int y) { return raw.cfa[(y & 1) * 2 + (x & 1)]; };
  if (colourAt(cell_x, cell_y) == colour) {
    out.offsets[out.count++] = {0, 0};
    return out;
  }
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (colourAt(cell_x + dx, cell_y + dy) == colour)
        out.offsets[out.count++] = {static_cast<std::int8_t>(dx), static_cast<std::int8_t>(dy)};
  return out;
}

struct Levels {
  float black, scale;
};

Levels levelsOf(const RawMosaic& raw) {
  if (!(raw.white_level > raw.black_level))
    throw ProcessingError(Exit::kBadData, "the raw file's white level is not above its black one");
  return {static_cast<float>(raw.black_level),
          static_cast<float>(1.0 / (raw.white_level - raw.black_level))};
}

}  // namespace

Image<float> demosaic(const RawMosaic& raw) {
  const ImageView<const std::uint16_t> in = raw.samples.view();
  const Levels levels = levelsOf(raw);
  std::array<Neighbours, 12> table;  // [cell y][cell x][colour]
  for (int i = 0; i < 12; ++i) table[i] = neighboursOf(raw, (i / 3) & 1, i / 6, i % 3);
  Image<float> out(in.width, in.height, 3);
  const ImageView<float> to = out.view();
  forEachRow(in.height, std::int64_t{24} * in.width, [&](int y) {
    const bool inner_row = y > 0 && y + 1 < in.height;
    float* row = to.row(y);
    for (int x = 0; x < in.width; ++x) {
      const bool inner = inner_row && x > 0 && x + 1 < in.width;
      for (int c = 0; c < 3; ++c) {
        const Neighbours& n = table[((y & 1) * 2 + (x & 1)) * 3 + c];
        int sum = 0, count = inner ? n.count : 0;
        for (int i = 0; i < n.count; ++i) {
          const int sx = x + n.offsets[i].dx, sy = y + n.offsets[i].dy;
          if (!inner && (sx < 0 || sy < 0 || sx >= in.width || sy >= in.height)) continue;
          sum += in.at(sx, sy);
          count += inner ? 0 : 1;
        }
        *row++ = count > 0 ? (static_cast<float>(sum) / static_cast<float>(count) - levels.black) *
                                 levels.scale
                           : 0.0f;
      }
    }
  });
  return out;
}

Image<float> demosaicHalf(const RawMosaic& raw) {
  const ImageView<const std::uint16_t> in = raw.samples.view();
  const Levels levels = levelsOf(raw);
  std::array<float, 3> weight{};
  for (std::uint8_t colour : raw.cfa) weight[colour] += 1;
  for (float& w : weight) w = w > 0 ? 1 / w : 0;
  Image<float> out(in.width / 2, in.height / 2, 3);
  const ImageView<float> to = out.view();
  forEachRow(out.height(), std::int64_t{4} * in.width, [&](int y) {
    const std::uint16_t* rows[2] = {in.row(2 * y), in.row(2 * y + 1)};
    for (int x = 0; x < to.width; ++x) {
      std::array<int, 3> sum{};
      for (int i = 0; i < 4; ++i) sum[raw.cfa[i]] += rows[i / 2][2 * x + i % 2];
      for (int c = 0; c < 3; ++c)
        to.at(x, y, c) = (static_cast<float>(sum[c]) * weight[c] - levels.black) * levels.scale;
    }
  });
  return out;
}

}  // namespace patina
