// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/linear_mosaic.h"

#include "processing/image/parallel_rows.h"

namespace patina {
namespace {

// Mean of a colour's samples in the 3x3 window that lie inside; the sample itself where it is of
// that colour.
float meanNear(ImageView<const float> in, const std::array<std::uint8_t, 4>& cfa, int x, int y,
               int colour) {
  const auto colourAt = [&](int px, int py) {
    const int cell = (py & 1) * 2 + (px & 1);
    return cfa[static_cast<std::size_t>(cell)];
  };
  if (colourAt(x, y) == colour) return in.at(x, y);
  float sum = 0;
  int count = 0;
  for (int py = std::max(0, y - 1); py <= std::min(in.height - 1, y + 1); ++py)
    for (int px = std::max(0, x - 1); px <= std::min(in.width - 1, x + 1); ++px)
      if (colourAt(px, py) == colour) {
        sum += in.at(px, py);
        ++count;
      }
  return count > 0 ? sum / static_cast<float>(count) : 0;
}

// Red and blue on a diagonal of the cell, green on the other.
bool isBayer(const std::array<std::uint8_t, 4>& cfa) {
  return (cfa[0] == 1 && cfa[3] == 1 && cfa[1] + cfa[2] == 2 && cfa[1] != 1) ||
         (cfa[1] == 1 && cfa[2] == 1 && cfa[0] + cfa[3] == 2 && cfa[0] != 1);
}

}  // namespace

Image<float> demosaicLinear(ImageView<const float> in, const std::array<std::uint8_t, 4>& cfa) {
  PATINA_CHECK(in.channels == 1);
  Image<float> out(in.width, in.height, 3);
  const ImageView<float> to = out.view();
  const bool bayer = isBayer(cfa);
  forEachRow(in.height, std::int64_t{8} * in.width, [&](int y) {
    const auto slowly = [&](int x) {
      for (int c = 0; c < 3; ++c) to.at(x, y, c) = meanNear(in, cfa, x, y, c);
    };
    if (!bayer || y == 0 || y + 1 == in.height || in.width < 3) {
      for (int x = 0; x < in.width; ++x) slowly(x);
      return;
    }
    slowly(0);
    slowly(in.width - 1);
    const float *up = in.row(y - 1), *row = in.row(y), *down = in.row(y + 1);
    const std::size_t line = static_cast<std::size_t>(y & 1) * 2;
    const int green = cfa[line] == 1 ? 0 : 1;
    const int own = cfa[line + 1 - static_cast<std::size_t>(green)], across = 2 - own;
    float* texel = to.row(y);
    for (int x = 1; x + 1 < in.width; ++x) {
      const float beside = row[x - 1] + row[x + 1], above = up[x] + down[x];
      if ((x & 1) == green) {
        texel[3 * x + own] = beside * 0.5f;
        texel[3 * x + 1] = row[x];
        texel[3 * x + across] = above * 0.5f;
      } else {
        const float corners = up[x - 1] + up[x + 1] + down[x - 1] + down[x + 1];
        texel[3 * x + own] = row[x];
        texel[3 * x + 1] = (beside + above) * 0.25f;
        texel[3 * x + across] = corners * 0.25f;
      }
    }
  });
  return out;
}

Image<float> demosaicDetailed(ImageView<const float> in, const std::array<std::uint8_t, 4>& cfa) {
  Image<float> out = demosaicLinear(in, cfa);
  if (!isBayer(cfa)) return out;
  const auto colourAt = [&](int x, int y) {
    const int cell = (y & 1) * 2 + (x & 1);
    return cfa[static_cast<std::size_t>(cell)];
  };
  forEachRow(in.height, std::int64_t{16} * in.width, [&](int y) {
    if (y < 2 || y + 2 >= in.height) return;
    for (int x = 2; x + 2 < in.width; ++x) {
      const auto at = [&](int dx, int dy) { return in.at(x + dx, y + dy); };
      const float own = at(0, 0), far_x = at(-2, 0) + at(2, 0), far_y = at(0, -2) + at(0, 2),
                  corners = at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1);
      const int colour = colourAt(x, y);
      if (colour == 1) {
        const float along = (5 * own - far_x - corners + far_y / 2) / 8,
                    down = (5 * own - far_y - corners + far_x / 2) / 8;
        out.at(x, y, colourAt(x + 1, y)) += along;
        out.at(x, y, colourAt(x, y + 1)) += down;
      } else {
        out.at(x, y, 1) += (4 * own - far_x - far_y) / 8;
        out.at(x, y, 2 - colour) += (12 * own - 3 * (far_x + far_y)) / 16;
      }
    }
  });
  return out;
}

}  // namespace patina
