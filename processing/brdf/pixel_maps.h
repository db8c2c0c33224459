// SPDX-License-Identifier: GPL-3.0-or-later
// From reflectance fitted pixel by pixel to texels of several pixels. A cast shadow's edge, a crack
// and what lies beside it, blades that turn every way: each is one thing within a pixel, and none
// within a texel, whose mean picture no one normal and lobe gives.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "processing/brdf/brdf_file.h"

namespace patina::brdf {

using Filters = std::array<std::uint8_t, 4>;  // colours of a 2x2 cell: 0 red, 1 green, 2 blue

// [h][w][1]: of each pixel the channel that its filter lets through. Needs three channels.
Image<float> ownColours(ImageView<const float> picture, const Filters& filters);

// Each texel the mean over its bin x bin pixels: of diffuse and specular colour, roughness, the
// extra maps, and the normal, made a unit again. Pixels that are not `told` ([h][w][1]) are what
// those around them are on average. With `filters` the colours are mosaics and interpolated first,
// with the detail that other colours show (demosaicDetailed). Rows in parallel; O(pixels).
BrdfMaps texelsOfPixels(const BrdfMaps& pixels, const Image<std::uint8_t>& told,
                        const std::optional<Filters>& filters, int bin);

}  // namespace patina::brdf
