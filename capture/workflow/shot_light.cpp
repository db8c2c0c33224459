// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/shot_light.h"

#include <cmath>

namespace patina::workflow {
namespace {

constexpr double kClipped = 0.97;  // of full scale: above it some of the patch may be
constexpr const char* kChannels[3] = {"patch_r", "patch_g", "patch_b"};

}  // namespace

std::array<float, 3> lightGainOf(const std::vector<db::LightCheckRow>& checks,
                                 const std::string& camera) {
  std::array<float, 3> gain{1, 1, 1};
  int best[3] = {0, 0, 0};
  for (const db::LightCheckRow& check : checks) {
    // Of a patch that was covered it is the gain before that.
    if (check.verdict != "correct" && check.verdict != "pass" && check.verdict != "covered")
      continue;
    if (!(check.gain > 0) || !std::isfinite(check.gain)) continue;
    const bool patch = check.source == "patch:" + camera;
    if (!patch && check.source.starts_with("patch:")) continue;
    for (int c = 0; c < 3; ++c) {
      const bool own = check.channel == std::string(1, "rgb"[c]);
      if (!own && (check.channel == "r" || check.channel == "g" || check.channel == "b")) continue;
      const int rank = 1 + own + 2 * patch;
      if (rank <= best[c]) continue;
      best[c] = rank;
      gain[static_cast<std::size_t>(c)] = static_cast<float>(check.gain);
    }
  }
  return gain;
}

std::optional<ChannelLevels> patchLevelOf(const std::vector<db::LightCheckRow>& checks,
                                          const std::string& camera) {
  ChannelLevels levels{};
  for (const db::LightCheckRow& check : checks) {
    const std::string& verdict = check.verdict;
    if (check.source != "patch:" + camera || verdict == "saturated" || verdict == "hold" ||
        verdict == "fail" || check.level > kClipped)
      continue;
    const bool judged = check.baseline > 0 && check.gain > 0;
    if (verdict == "covered" && !judged) continue;
    const double level = judged ? check.baseline / check.gain : check.level;
    for (std::size_t c = 0; c < 3; ++c)
      if (check.channel == "y" || check.channel == std::string(1, "rgb"[c])) levels[c] = level;
  }
  for (const double level : levels)
    if (!(level > 0) || !std::isfinite(level)) return std::nullopt;
  return levels;
}

void addPatch(Facts& values, const std::optional<ChannelLevels>& level) {
  if (!level) return;
  for (std::size_t c = 0; c < level->size(); ++c) values.number(kChannels[c], (*level)[c]);
}

std::optional<ChannelLevels> patchIn(const Facts& values) {
  ChannelLevels level{};
  for (std::size_t c = 0; c < level.size(); ++c) {
    level[c] = values.number(kChannels[c]).value_or(0);
    if (!(level[c] > 0) || !std::isfinite(level[c])) return std::nullopt;
  }
  return level;
}

}  // namespace patina::workflow
