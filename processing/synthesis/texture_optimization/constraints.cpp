// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/constraints.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace patina::texture_optimization {
namespace {

constexpr int kGuideChannelsMax = 24;

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kUsage, what); }

std::string text(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

// `more` behind the channels of `to`.
void append(Image<float>& to, ImageView<const float> more, float factor) {
  Image<float> wider(more.width, more.height,
                     to.empty() ? more.channels : to.channels() + more.channels);
  const int before = wider.channels() - more.channels;
  for (int y = 0; y < more.height; ++y)
    for (int x = 0; x < more.width; ++x) {
      float* at = &wider.at(x, y);
      if (before > 0) std::copy_n(&to.at(x, y), before, at);
      for (int c = 0; c < more.channels; ++c) at[before + c] = factor * more.at(x, y, c);
    }
  to = std::move(wider);
}

Image<float> places(SizePx size) {
  Image<float> out(size.width, size.height, 2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      out.at(x, y, 0) = (static_cast<float>(x) + 0.5f) / static_cast<float>(size.width);
      out.at(x, y, 1) = (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height);
    }
  return out;
}

}  // namespace

std::vector<std::uint8_t> whiteOf(ImageView<const float> mask) {
  std::vector<std::uint8_t> out;
  out.reserve(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) out.push_back(mask.at(x, y) >= 0.5f);
  return out;
}

std::vector<std::int32_t> keptFrom(ImageView<const float> mask, SizePx sample, int from_x,
                                   int from_y) {
  const std::vector<std::uint8_t> white = whiteOf(mask);
  std::vector<std::int32_t> out(white.size(), -1);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                      static_cast<std::size_t>(x);
      if (white[at] == 0) continue;
      const int sx = x + from_x, sy = y + from_y;
      if (sx < 0 || sx >= sample.width || sy < 0 || sy >= sample.height)
        refuse("what shall stay at " + std::to_string(x) + "," + std::to_string(y) +
               " lies outside the sample of " + text(sample) +
               ": paint less of the mask white, or move where it is taken from");
      out[at] = sy * sample.width + sx;
    }
  return out;
}

void addGuide(Constraints& constraints, ImageView<const float> sample,
              ImageView<const float> result, double weight) {
  Image<float>&from = constraints.sample_guide, &to = constraints.result_guide;
  if (!(weight > 0 && weight <= 1e6))
    refuse("a guide's weight is " + std::to_string(weight) + "; it lies above 0 and up to 1e6");
  if (sample.channels != result.channels)
    refuse("a guide has " + std::to_string(sample.channels) + " channels for the sample and " +
           std::to_string(result.channels) + " for the result");
  if (!from.empty() && (from.size() != sample.size() || to.size() != result.size()))
    refuse("a guide is " + text(sample.size()) + " and " + text(result.size()) +
           " texels, the one before " + text(from.size()) + " and " + text(to.size()));
  if ((from.empty() ? 0 : from.channels()) + sample.channels > kGuideChannelsMax)
    refuse("the guides have more than 24 channels");
  for (const ImageView<const float>& guide : {sample, result})
    for (int y = 0; y < guide.height; ++y)
      for (int x = 0; x < guide.width; ++x)
        for (int c = 0; c < guide.channels; ++c)
          if (!std::isfinite(guide.at(x, y, c)))
            throw ProcessingError(Exit::kBadData, "a guide holds a value that is no number at " +
                                                      std::to_string(x) + "," + std::to_string(y));
  const auto factor = static_cast<float>(std::sqrt(weight));
  append(from, sample, factor);
  append(to, result, factor);
}

void addGradientGuides(Constraints& constraints, SizePx sample, SizePx result, double weight) {
  addGuide(constraints, places(sample).view(), places(result).view(), weight);
}

}  // namespace patina::texture_optimization
