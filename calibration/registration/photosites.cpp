// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/photosites.h"

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kEvery = 16;          // rows looked at, two by two
constexpr double kStandsOut = 1.5;  // in mean square
// Green between four of its own is their mean and is not bent at all; of a flat-corrected picture,
// next to nothing. Other interpolations are told by that.
constexpr double kGreenStandsOut = 10;

// Mean square of a channel's Laplacian by place in the cell.
std::array<double, 4> roughnessOf(ImageView<const float> in, int c) {
  std::array<double, 4> sum{};
  std::array<int, 4> count{};
  for (int y = 2; y + 2 < in.height; y += (y & 1) == 0 ? 1 : kEvery - 1)
    for (int x = 1; x + 1 < in.width; ++x) {
      const float bent = 4 * in.at(x, y, c) - in.at(x - 1, y, c) - in.at(x + 1, y, c) -
                         in.at(x, y - 1, c) - in.at(x, y + 1, c);
      const std::size_t at = placeInCell(x, y);
      sum[at] += static_cast<double>(bent) * bent;
      ++count[at];
    }
  for (std::size_t k = 0; k < 4; ++k) sum[k] /= std::max(count[k], 1);
  return sum;
}

}  // namespace

Photosites photositesOf(ImageView<const float> linear) {
  Photosites out;
  if (linear.channels != 3) return out;
  const auto red = roughnessOf(linear, 0), green = roughnessOf(linear, 1),
             blue = roughnessOf(linear, 2);
  for (const std::array<std::uint8_t, 4>& cfa :
       {std::array<std::uint8_t, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    std::array<std::size_t, 3> at{};  // of red, the first green, blue
    for (std::size_t k = 4; k-- > 0;) at[cfa[k]] = k;
    const bool fits =
        red[at[0]] > kStandsOut * red[at[2]] && blue[at[2]] > kStandsOut * blue[at[0]] &&
        green[at[1]] + green[3 - at[1]] > kGreenStandsOut * (green[at[0]] + green[at[2]]);
    if (!fits) continue;
    out.cfa = cfa;
    out.samples = Image<float>(linear.width, linear.height, 1);
    const ImageView<float> to = out.samples.view();
    forEachRow(linear.height, std::int64_t{2} * linear.width, [&](int y) {
      const float* from = linear.row(y);
      float* own = to.row(y);
      for (int x = 0; x < linear.width; ++x) own[x] = from[3 * x + out.colourAt(x, y)];
    });
    return out;
  }
  return out;
}

}  // namespace patina::calibration
