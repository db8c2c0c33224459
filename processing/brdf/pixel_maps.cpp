// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/pixel_maps.h"

#include <algorithm>
#include <cmath>

#include "processing/brdf/vector.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr int kFillReach = 10;  // px

std::size_t cellOf(int x, int y) {
  return static_cast<std::size_t>(y & 1) * 2 + static_cast<std::size_t>(x & 1);
}

// What is not told is the mean of what is, in the smallest square around it that has any; by steps
// that meet the same colour of a mosaic.
void fill(Image<float>& map, const Image<std::uint8_t>& told, int step) {
  const Image<float> from = map;
  forEachRow(map.height(), std::int64_t{map.width()} * 8, [&](int y) {
    for (int x = 0; x < map.width(); ++x) {
      if (told.at(x, y)) continue;
      int count = 0;
      for (int reach = step; reach <= kFillReach && count == 0; reach += step) {
        std::array<float, 3> sum{};
        for (int v = y - reach; v <= y + reach; v += step)
          for (int u = x - reach; u <= x + reach; u += step) {
            if (u < 0 || v < 0 || u >= map.width() || v >= map.height() || !told.at(u, v)) continue;
            ++count;
            for (int c = 0; c < map.channels(); ++c)
              sum[static_cast<std::size_t>(c)] += from.at(u, v, c);
          }
        for (int c = 0; c < map.channels() && count > 0; ++c)
          map.at(x, y, c) = sum[static_cast<std::size_t>(c)] / static_cast<float>(count);
      }
    }
  });
}

Image<float> meansOf(const Image<float>& pixels, int bin) {
  Image<float> out(pixels.width() / bin, pixels.height() / bin, pixels.channels());
  const float share = 1 / static_cast<float>(bin * bin);
  forEachRow(out.height(), std::int64_t{pixels.width()} * bin * pixels.channels(), [&](int y) {
    for (int v = y * bin; v < (y + 1) * bin; ++v)
      for (int u = 0; u < out.width() * bin; ++u)
        for (int c = 0; c < pixels.channels(); ++c)
          out.at(u / bin, y, c) += share * pixels.at(u, v, c);
  });
  return out;
}

// Of a mosaic, all three colours everywhere.
Image<float> coloursOf(const Image<float>& map, const std::optional<Filters>& filters) {
  if (!filters) return map;
  Image<float> colours = demosaicDetailed(map.view(), *filters);
  const float most = *std::max_element(map.texels().begin(), map.texels().end());
  for (float& v : colours.texels()) v = std::clamp(v, 0.0f, most);
  return colours;
}

}  // namespace

Image<float> ownColours(ImageView<const float> picture, const Filters& filters) {
  PATINA_CHECK(picture.channels == 3);
  Image<float> out(picture.width, picture.height, 1);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) out.at(x, y) = picture.at(x, y, filters[cellOf(x, y)]);
  return out;
}

BrdfMaps texelsOfPixels(const BrdfMaps& pixels, const Image<std::uint8_t>& told,
                        const std::optional<Filters>& filters, int bin) {
  const auto filled = [&](const Image<float>& map, int step) {
    Image<float> whole = map;
    fill(whole, told, step);
    return whole;
  };
  const int step = filters ? 2 : 1;
  BrdfMaps out;
  out.diffuse = meansOf(coloursOf(filled(pixels.diffuse, step), filters), bin);
  if (!pixels.specular.empty())
    out.specular = meansOf(coloursOf(filled(pixels.specular, step), filters), bin);
  if (!pixels.roughness.empty()) out.roughness = meansOf(filled(pixels.roughness, 1), bin);
  for (const auto& [name, map] : pixels.extra) out.extra[name] = meansOf(map, bin);
  out.normal = meansOf(filled(pixels.normal, 1), bin);
  for (int y = 0; y < out.normal.height(); ++y)
    for (int x = 0; x < out.normal.width(); ++x) {
      const auto n = out.normal.view().texel(x, y);
      const Vec3 unit = normalized({n[0], n[1], n[2]});
      n[0] = unit.x, n[1] = unit.y, n[2] = unit.z;
    }
  return out;
}

}  // namespace patina::brdf
