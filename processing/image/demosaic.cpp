// SPDX-License-Identifier: GPL-3.0-or-later
// From a mosaic of colour filters to three channels, for dng_file.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/dng_file.h"
#include "processing/image/encoding.h"
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

constexpr int kChunk = 256;  // texels of a row taken together

// What every demosaic of a mosaic shares.
class Bilinear {
 public:
  explicit Bilinear(const RawMosaic& raw) : in_(raw.samples.view()), levels_(levelsOf(raw)) {
    for (int i = 0; i < 12; ++i) table_[i] = neighboursOf(raw, (i / 3) & 1, i / 6, i % 3);
    const auto& cfa = raw.cfa;
    const bool falling = cfa[0] == 1 && cfa[3] == 1, rising = cfa[1] == 1 && cfa[2] == 1;
    const int a = falling ? cfa[1] : cfa[0], b = falling ? cfa[2] : cfa[3];
    bayer_ = falling != rising && a + b == 2 && a != b;
    for (int y = 0; y < 2; ++y) {
      green_[y] = cfa[2 * y] == 1 ? 0 : 1;
      other_[y] = cfa[2 * y + 1 - green_[y]];
    }
  }
  SizePx size() const { return in_.size(); }
  // Whether quarters() knows all but the first and last texel of a row.
  bool quick(int y) const { return bayer_ && in_.width > 2 && y > 0 && y + 1 < in_.height; }
  float value(float sample) const { return (sample - levels_.black) * levels_.scale; }

  // One texel anywhere, of any mosaic: the mean of the neighbours that are inside.
  template <class Put>
  void texel(int x, int y, const Put& put) const {
    for (int c = 0; c < 3; ++c) {
      const Neighbours& n = table_[((y & 1) * 2 + (x & 1)) * 3 + c];
      int sum = 0, count = 0;
      for (int i = 0; i < n.count; ++i) {
        const int sx = x + n.offsets[i].dx, sy = y + n.offsets[i].dy;
        if (sx < 0 || sy < 0 || sx >= in_.width || sy >= in_.height) continue;
        sum += in_.at(sx, sy);
        ++count;
      }
      put(c, count > 0 ? value(static_cast<float>(sum) / static_cast<float>(count)) : 0.0f);
    }
  }
  // Four times the means of an inner row, which are whole numbers: put(index in the row, quarters,
  // how many), for all but its first and last texel, in pieces.
  template <class Put>
  void quarters(int y, const Put& put) const {
    const std::uint16_t *up = in_.row(y - 1), *row = in_.row(y), *down = in_.row(y + 1);
    const int own = other_[y & 1], across = 2 - own;
    int beside[kChunk], above[kChunk], corners[kChunk], out[3 * kChunk];
    for (int x0 = 1; x0 + 1 < in_.width; x0 += kChunk) {
      const int count = std::min(kChunk, in_.width - 1 - x0);
      for (int i = 0; i < count; ++i) {  // vectorises
        const int x = x0 + i;
        beside[i] = row[x - 1] + row[x + 1];
        above[i] = up[x] + down[x];
        corners[i] = up[x - 1] + up[x + 1] + down[x - 1] + down[x + 1];
      }
      const auto atGreen = [&](int i) {
        out[3 * i + own] = 2 * beside[i];
        out[3 * i + 1] = 4 * row[x0 + i];
        out[3 * i + across] = 2 * above[i];
      };
      const auto atOther = [&](int i) {
        out[3 * i + own] = 4 * row[x0 + i];
        out[3 * i + 1] = beside[i] + above[i];
        out[3 * i + across] = corners[i];
      };
      int i = 0;
      if ((x0 & 1) != green_[y & 1]) atOther(i++);
      for (; i + 1 < count; i += 2) {
        atGreen(i);
        atOther(i + 1);
      }
      if (i < count) atGreen(i);
      put(3 * x0, out, 3 * count);
    }
  }

 private:
  ImageView<const std::uint16_t> in_;
  Levels levels_;
  std::array<Neighbours, 12> table_;      // [cell y][cell x][colour]
  bool bayer_ = false;                    // green on a diagonal, red and blue on the other
  std::array<int, 2> green_{}, other_{};  // by row: x of the green cell, the other colour
};

// Rows of three channels: inner texels by `quarter`, those on the border by `whole`.
// By value: a pointer in a reference would be read again after every byte written.
template <class T, class Quarter, class Whole>
Image<T> develop(const Bilinear& bilinear, Quarter quarter, Whole whole) {
  const auto [width, height] = bilinear.size();
  Image<T> out(width, height, 3);
  const ImageView<T> to = out.view();
  forEachRow(height, std::int64_t{8} * width, [&, quarter, width = width](int y) {
    T* row = to.row(y);
    const auto slowly = [&](int x) {
      bilinear.texel(x, y, [&](int c, float v) { row[3 * x + c] = whole(v); });
    };
    if (!bilinear.quick(y)) {
      for (int x = 0; x < width; ++x) slowly(x);
      return;
    }
    slowly(0);
    bilinear.quarters(y, [quarter, row](int at, const int* quarters, int count) {
      T* to_row = row + at;
      for (int i = 0; i < count; ++i) to_row[i] = quarter(quarters[i]);
    });
    slowly(width - 1);
  });
  return out;
}

}  // namespace

Image<float> demosaic(const RawMosaic& raw) {
  const Bilinear bilinear(raw);
  return develop<float>(
      bilinear, [&](int quarters) { return bilinear.value(static_cast<float>(quarters) * 0.25f); },
      [](float v) { return v; });
}

SrgbDeveloper::SrgbDeveloper(double black_level, double white_level)
    : black_level_(black_level), white_level_(white_level) {
  RawMosaic ramp;
  ramp.black_level = black_level;
  ramp.white_level = white_level;
  const Levels levels = levelsOf(ramp);
  // One past white: what lies above it is clipped to the same code.
  Image<float> linear(4 * static_cast<int>(std::ceil(white_level)) + 5, 1, 1);
  for (int i = 0; i < linear.width(); ++i)
    linear.at(i, 0) = (static_cast<float>(i) * 0.25f - levels.black) * levels.scale;
  codes_ = encodeSrgb8(linear.view()).texels();
}

Image<std::uint8_t> SrgbDeveloper::operator()(const RawMosaic& raw) const {
  PATINA_CHECK(raw.black_level == black_level_ && raw.white_level == white_level_);
  const std::uint8_t* codes = codes_.data();
  const int top = static_cast<int>(codes_.size()) - 1;
  return develop<std::uint8_t>(
      Bilinear(raw), [=](int quarters) { return codes[std::min(quarters, top)]; },
      [](float v) { return encodeSrgb8(v); });
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
