// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::texture_optimization {
namespace {

std::size_t indexOf(SizePx size, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
         static_cast<std::size_t>(x);
}

// Of length `from`, what lies beneath texel i of length `to`: [first, last).
struct Beneath {
  int first, last;
};
Beneath beneath(int i, int from, int to) {
  return {static_cast<int>(std::int64_t{i} * from / to),
          static_cast<int>((std::int64_t{i} * from + from + to - 1) / to)};
}

}  // namespace

SizePx halved(SizePx size, int times) {
  return {std::max(1, size.width >> times), std::max(1, size.height >> times)};
}

Image<std::int16_t> averaged(const Image<std::int16_t>& in, SizePx size) {
  if (in.empty() || in.size() == size) return in;
  const int channels = in.channels();
  Image<std::int16_t> out(size.width, size.height, channels);
  const double sx = static_cast<double>(in.width()) / size.width,
               sy = static_cast<double>(in.height()) / size.height;
  tbb::parallel_for(0, size.height, [&](int y) {
    std::vector<double> sum(static_cast<std::size_t>(channels));
    for (int x = 0; x < size.width; ++x) {
      std::fill(sum.begin(), sum.end(), 0);
      for (int iy = static_cast<int>(y * sy); iy < std::min<double>(in.height(), (y + 1) * sy);
           ++iy)
        for (int ix = static_cast<int>(x * sx); ix < std::min<double>(in.width(), (x + 1) * sx);
             ++ix) {
          const double share = (std::min(ix + 1.0, (x + 1) * sx) - std::max<double>(ix, x * sx)) *
                               (std::min(iy + 1.0, (y + 1) * sy) - std::max<double>(iy, y * sy));
          for (int c = 0; c < channels; ++c)
            sum[static_cast<std::size_t>(c)] += share * in.at(ix, iy, c);
        }
      for (int c = 0; c < channels; ++c)
        out.at(x, y, c) =
            static_cast<std::int16_t>(std::lrint(sum[static_cast<std::size_t>(c)] / (sx * sy)));
    }
  });
  return out;
}

std::vector<std::uint8_t> allBeneath(const std::vector<std::uint8_t>& mask, SizePx size,
                                     SizePx smaller) {
  if (mask.empty()) return {};
  std::vector<std::uint8_t> out(indexOf(smaller, 0, smaller.height), 1);
  for (int y = 0; y < smaller.height; ++y)
    for (int x = 0; x < smaller.width; ++x) {
      const Beneath across = beneath(x, size.width, smaller.width),
                    down = beneath(y, size.height, smaller.height);
      for (int iy = down.first; iy < down.last; ++iy)
        for (int ix = across.first; ix < across.last; ++ix)
          out[indexOf(smaller, x, y)] &= mask[indexOf(size, ix, iy)] != 0;
    }
  return out;
}

std::vector<std::int32_t> keptBeneath(const std::vector<std::int32_t>& kept, SizePx target,
                                      SizePx smaller_target, SizePx source, SizePx smaller_source) {
  if (kept.empty()) return {};
  std::vector<std::uint8_t> mask(kept.size());
  std::transform(kept.begin(), kept.end(), mask.begin(), [](std::int32_t k) { return k >= 0; });
  mask = allBeneath(mask, target, smaller_target);
  std::vector<std::int32_t> out(mask.size(), -1);
  for (int y = 0; y < smaller_target.height; ++y)
    for (int x = 0; x < smaller_target.width; ++x) {
      const std::size_t at = indexOf(smaller_target, x, y);
      if (mask[at] == 0) continue;
      const Beneath across = beneath(x, target.width, smaller_target.width),
                    down = beneath(y, target.height, smaller_target.height);
      const std::int32_t texel =
          kept[indexOf(target, (across.first + across.last) / 2, (down.first + down.last) / 2)];
      const int sx = static_cast<int>(std::int64_t{texel % source.width} * smaller_source.width /
                                      source.width),
                sy = static_cast<int>(std::int64_t{texel / source.width} * smaller_source.height /
                                      source.height);
      out[at] = static_cast<std::int32_t>(indexOf(smaller_source, sx, sy));
    }
  return out;
}

bool holdsPatch(const std::vector<std::uint8_t>& usable, SizePx size, int patch) {
  if (usable.empty()) return std::min(size.width, size.height) >= patch;
  // The side of the largest square of 1s that ends at each texel.
  std::vector<int> side(usable.size(), 0);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const std::size_t at = indexOf(size, x, y);
      if (usable[at] == 0) continue;
      side[at] = x == 0 || y == 0 ? 1
                                  : 1 + std::min({side[at - 1], side[indexOf(size, x, y - 1)],
                                                  side[indexOf(size, x - 1, y - 1)]});
      if (side[at] >= patch) return true;
    }
  return false;
}

std::vector<std::int32_t> scattered(SizePx source, SizePx target,
                                    const patch::FieldOptions& options) {
  const int reach = options.patch / 2;
  std::vector<std::int32_t> out;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const std::uint64_t key = hashSeed(options.seed, 0x73, static_cast<std::uint64_t>(x),
                                         static_cast<std::uint64_t>(y));
      const auto within = [&](std::uint64_t seed, int length) {
        return reach +
               static_cast<int>(uniformBelow(seed, static_cast<std::uint64_t>(length - 2 * reach)));
      };
      out.push_back(within(hashSeed(key, 1), source.height) * source.width +
                    within(hashSeed(key, 2), source.width));
    }
  return out;
}

std::vector<std::int32_t> refined(const std::vector<std::int32_t>& coarse, SizePx coarse_source,
                                  SizePx coarse_target, SizePx source, SizePx target, int reach) {
  const int times = coarse_source == source ? 1 : 2;
  std::vector<std::int32_t> out;
  out.reserve(static_cast<std::size_t>(target.width) * static_cast<std::size_t>(target.height));
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const int cx = std::min(x / times, coarse_target.width - 1),
                cy = std::min(y / times, coarse_target.height - 1);
      const std::int32_t centre =
          coarse[static_cast<std::size_t>(cy) * static_cast<std::size_t>(coarse_target.width) +
                 static_cast<std::size_t>(cx)];
      const int sx = centre % coarse_source.width * times + x % times,
                sy = centre / coarse_source.width * times + y % times;
      out.push_back(std::clamp(sy, reach, source.height - 1 - reach) * source.width +
                    std::clamp(sx, reach, source.width - 1 - reach));
    }
  return out;
}

}  // namespace patina::texture_optimization
