// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/lit_lamp.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibration/lamps/reduced_grey.h"

namespace patina::calibration {
namespace {

using Blocks = std::vector<double>;

constexpr double kLeastMisfit = 1e-4;  // of two pictures of the same: what rounding leaves

Blocks blocksOf(ImageView<const float> picture, int aside) {
  const Image<float> grey = reducedGrey(picture, reductionTo(aside, picture.size()));
  Blocks blocks(grey.texels().begin(), grey.texels().end());
  for (double& level : blocks) level = std::max(level, 0.0);
  return blocks;
}

double meanOf(const Blocks& blocks) {
  return std::accumulate(blocks.begin(), blocks.end(), 0.0) / static_cast<double>(blocks.size());
}

double misfitOf(const Blocks& a, const Blocks& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
  }
  return std::sqrt(std::max(1 - ab * ab / std::max(aa * bb, 1e-300), 0.0));
}

}  // namespace

void LitLampOptions::check() const {
  if (blocks_aside < 4 || blocks_aside > 256)
    throw CalibrationError(Exit::kUsage, "blocks_aside is 4 to 256");
  if (!(dark_below > 0 && dark_below < 1) || !(margin_least > 0 && margin_least < 1))
    throw CalibrationError(Exit::kUsage, "dark_below and margin_least lie between 0 and 1");
}

LitLamp confirmLitLamp(ImageView<const float> frame,
                       std::span<const ImageView<const float>> references,
                       const LitLampOptions& options) {
  options.check();
  if (references.size() < 2)
    throw CalibrationError(Exit::kUsage, "one lamp cannot be told from others: give two or more");
  std::vector<Blocks> lamps;
  double brightest = 0;
  for (const ImageView<const float>& reference : references) {
    if (reference.size() != frame.size())
      throw CalibrationError(Exit::kBadData, "a lamp's picture is of another size than the frame");
    lamps.push_back(blocksOf(reference, options.blocks_aside));
    const double mean = meanOf(lamps.back());
    if (!(mean > 0)) throw CalibrationError(Exit::kBadData, "the picture of a lamp is dark");
    brightest = std::max(brightest, mean);
  }
  Blocks seen = blocksOf(frame, options.blocks_aside);
  LitLamp out;
  if (meanOf(seen) < options.dark_below * brightest) {
    out.verdict = LitLamp::kDark;
    return out;
  }
  Blocks together(seen.size());
  for (const Blocks& lamp : lamps)
    for (std::size_t i = 0; i < together.size(); ++i) together[i] += lamp[i];
  // Where the surface is all but black there is no shading to see.
  const double least = 0.05 * meanOf(together);
  const auto relative = [&](Blocks& blocks) {
    for (std::size_t i = 0; i < blocks.size(); ++i)
      blocks[i] = together[i] > least ? blocks[i] / together[i] : 0;
  };
  relative(seen);
  for (Blocks& lamp : lamps) {
    relative(lamp);
    out.misfit.push_back(misfitOf(seen, lamp));
  }
  std::vector<int> order(lamps.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return out.misfit[a] < out.misfit[b]; });
  out.lamp = order[0];
  out.second = order[1];
  out.margin = 1 - (out.misfit[order[0]] + kLeastMisfit) / (out.misfit[order[1]] + kLeastMisfit);
  out.verdict = out.margin >= options.margin_least ? LitLamp::kLit : LitLamp::kUnclear;
  return out;
}

}  // namespace patina::calibration
