// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/palette.h"

#include <array>
#include <utility>

namespace patina::render {

Colour seriesColour(int index) {
  static constexpr std::array<Colour, 7> kSeries{{{0, 105, 170},
                                                  {208, 95, 20},
                                                  {0, 140, 105},
                                                  {170, 90, 145},
                                                  {150, 120, 0},
                                                  {60, 160, 210},
                                                  {90, 90, 90}}};
  return kSeries[static_cast<std::size_t>(index % 7 + 7) % 7];
}

Colour meaningColour(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, Colour>, 14> kMeanings{{
      {"pass", {0, 140, 105}},
      {"captured", {0, 140, 105}},
      {"correct", {0, 105, 170}},
      {"hold", {226, 145, 0}},
      {"held", {226, 145, 0}},
      {"fail", {196, 40, 40}},
      {"failed", {196, 40, 40}},
      {"saturated", {150, 60, 150}},
      {"covered", {40, 40, 40}},
      {"at_odds", {190, 95, 140}},
      {"at odds", {190, 95, 140}},
      {"skipped", {150, 150, 150}},
      {"missed", {110, 70, 40}},
      {"partial", {80, 150, 200}},
  }};
  for (const auto& [name, colour] : kMeanings)
    if (name == word) return colour;
  return {135, 140, 146};
}

}  // namespace patina::render
