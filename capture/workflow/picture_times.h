// SPDX-License-Identifier: GPL-3.0-or-later
// When a picture was taken, as its name tells, and what rhythm a row of such times has. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "processing/image/units.h"

namespace patina::workflow {

// "frame9" before "frame10": runs of digits compare as numbers, the rest bytewise.
bool naturalLess(std::string_view a, std::string_view b);

// Finds, in this order: a date with or without a time of day (2023-05-17, 20230517,
// 2023_05_17_12-30, IMG_20230517_123015, 20230517T123015Z; taken as UTC), Unix seconds or
// milliseconds (10 or 13 digits), "day 3" or "hour 12" counted from `origin`.
std::optional<UtcTime> timeFromName(std::string_view name, UtcTime origin = UtcTime{});

// The steps that a row of rising times falls on.
struct Rhythm {
  bool regular = false;    // all but a few times lie on multiples of the interval
  Nanoseconds interval{};  // zero when not regular
  // Per time: its step. Nothing: between two steps, an extra picture (regular only). Not regular:
  // simply 0, 1, 2 ...
  std::vector<std::optional<std::int64_t>> numbers;
};
// The interval is the commonest distance between neighbours (within 10 %). Regular: at most one
// time in twenty lies further than a quarter of the interval from its step. Steps are counted from
// neighbour to neighbour, so a slow clock does not run out of step. O(n^2) in distinct distances.
Rhythm findRhythm(const std::vector<UtcTime>& times);

}  // namespace patina::workflow
