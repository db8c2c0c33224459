// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/usable_patches.h"

#include <string>

#include "processing/image/failure.h"

namespace patina::patch {

std::vector<std::uint8_t> usablePatches(std::span<const std::uint8_t> texels, SizePx source,
                                        int patch) {
  const int width = source.width, height = source.height, reach = patch / 2;
  std::vector<std::uint8_t> out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                                0);
  PATINA_CHECK(texels.empty() || texels.size() == out.size());
  bool any = false;
  for (int y = reach; y < height - reach; ++y)
    for (int x = reach; x < width - reach; ++x) {
      const int centre = y * width + x;
      bool all = true;
      for (int dy = -reach; dy <= reach && all && !texels.empty(); ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const int texel = centre + dy * width + dx;
          all &= texels[static_cast<std::size_t>(texel)] != 0;
        }
      out[static_cast<std::size_t>(centre)] = all;
      any |= all;
    }
  if (!any)
    throw ProcessingError(Exit::kUsage, "the mask leaves no whole patch of " +
                                            std::to_string(patch) + " texels to show");
  return out;
}

}  // namespace patina::patch
