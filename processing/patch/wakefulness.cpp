// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/wakefulness.h"

#include <algorithm>

#include "processing/image/failure.h"
#include "processing/image/parallel_rows.h"

namespace patina::patch {
namespace {

std::size_t texelsOf(SizePx size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

int within(int i, int length, bool wraps) {
  if (wraps) return (i % length + length) % length;
  return std::clamp(i, 0, length - 1);
}

}  // namespace

Wakefulness::Wakefulness(SizePx target, bool wraps, int passes)
    : target_(target),
      wraps_(wraps),
      kept_(static_cast<std::uint8_t>((1u << passes) - 1)),
      history_(texelsOf(target), 0),
      before_(texelsOf(target), 0),
      awake_(texelsOf(target), 0),
      since_vote_(texelsOf(target), 0) {
  PATINA_CHECK(passes >= 1 && passes <= 7);
}

void Wakefulness::wakeAll() { std::fill(history_.begin(), history_.end(), kept_); }

void Wakefulness::wakeOnly(const std::vector<std::uint8_t>& map) {
  PATINA_CHECK(map.size() == history_.size());
  std::transform(map.begin(), map.end(), history_.begin(),
                 [this](std::uint8_t awake) { return awake != 0 ? kept_ : std::uint8_t{0}; });
  std::fill(since_vote_.begin(), since_vote_.end(), std::uint8_t{1});
}

void Wakefulness::beginPass() {
  // Bit 0 is the pass that ended; what is left of it after the shift counts down `passes`.
  awake_ = spread(history_, 1);
  before_ = history_;
  for (std::uint8_t& h : history_) h = static_cast<std::uint8_t>((h << 1) & kept_);
}

std::vector<std::uint8_t> Wakefulness::takeChangesWithin(int reach) {
  std::vector<std::uint8_t> out = spread(since_vote_, reach);
  std::fill(since_vote_.begin(), since_vote_.end(), std::uint8_t{0});
  return out;
}

std::vector<std::uint8_t> Wakefulness::spread(const std::vector<std::uint8_t>& map,
                                              int reach) const {
  const int width = target_.width, height = target_.height;
  const auto row_of = [&](int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  };
  std::vector<std::uint8_t> across(map.size()), out(map.size());
  const std::int64_t cost = std::int64_t{width} * reach / 4;
  forEachRow(height, cost, [&](int y) {
    const std::uint8_t* from = &map[row_of(y)];
    std::uint8_t* to = &across[row_of(y)];
    for (int x = 0; x < width; ++x) to[x] = from[x] != 0;
    for (int d = 1; d <= reach; ++d) {
      for (int x = d; x < width; ++x) to[x] |= from[x - d] != 0;
      for (int x = 0; x < width - d; ++x) to[x] |= from[x + d] != 0;
      for (int i = 0; wraps_ && i < std::min(d, width); ++i) {
        to[i] |= from[within(i - d, width, true)] != 0;
        to[width - 1 - i] |= from[within(width - 1 - i + d, width, true)] != 0;
      }
    }
  });
  forEachRow(height, cost, [&](int y) {
    std::uint8_t* to = &out[row_of(y)];
    for (int d = -reach; d <= reach; ++d) {
      const std::uint8_t* from = &across[row_of(within(y + d, height, wraps_))];
      for (int x = 0; x < width; ++x) to[x] |= from[x];
    }
  });
  return out;
}

}  // namespace patina::patch
