// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/view_troubles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/twin/mosaic_blur.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"
#include "devices/twin/troubles.h"
#include "devices/twin/visitors.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr double kSwell = 0.1;       // share of its time in which a trouble comes, and goes
constexpr double kBlurMost = 0.125;  // of the picture's shorter side
constexpr double kDayS = 86'400;

struct Cover {
  FaultKind kind;
  std::array<float, 3> reflectance;  // rgb
  bool at_once;
};
constexpr Cover kCovers[] = {
    {FaultKind::kPatchSoiled, {0.045f, 0.034f, 0.022f}, true},
    {FaultKind::kPatchSnowed, {0.86f, 0.88f, 0.9f}, false},
    {FaultKind::kPatchOvergrown, {0.03f, 0.075f, 0.018f}, false},
};

// Begun, of this camera, and not over.
bool acts(const Fault& fault, FaultKind kind, const TroubledView& view) {
  return fault.kind == kind && fault.device == view.camera && isActive(fault, view.run_time);
}

// Share of its time that is past.
double pastShare(const Fault& fault, const TroubledView& view) {
  const Nanoseconds lasts = fault.duration < kFaultForEver
                                ? fault.duration
                                : std::max(view.process - fault.at, Nanoseconds{1});
  return toSeconds(view.run_time - fault.at) / toSeconds(lasts);
}

double swollen(double past) { return smooth01(saturate(static_cast<float>(past / kSwell))); }

int channelOf(int x, int y) { return (x & 1) + (y & 1); }

// Covers `amount` of the patch: its pixels by falling noise, so that more covers what less did.
void cover(const Cover& with, double amount, std::uint64_t key, const RectPx& patch,
           std::vector<float>& reflectance) {
  const std::size_t count = reflectance.size();
  const auto covered = static_cast<std::size_t>(std::lround(amount * static_cast<double>(count)));
  if (covered == 0) return;
  const float side = static_cast<float>(std::max(patch.width, patch.height));
  FractalNoise noise;
  noise.seed = key;
  noise.wavelength_mm = 0.4f;
  std::vector<float> height(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t column = k % static_cast<std::size_t>(patch.width),
                      row = k / static_cast<std::size_t>(patch.width);
    height[k] =
        noise.at(static_cast<float>(column) / side, static_cast<float>(row) / side, 1 / side);
  }
  std::vector<float> sorted = height;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(covered - 1),
                   sorted.end(), std::greater<>());
  const float least = sorted[covered - 1];
  for (std::size_t k = 0; k < count; ++k) {
    if (height[k] < least) continue;
    const int x = patch.x + static_cast<int>(k) % patch.width,
              y = patch.y + static_cast<int>(k) / patch.width;
    reflectance[k] = with.reflectance[channelOf(x, y)];
  }
}

void coverPatch(const FaultPlan& faults, const TroubledView& view, std::vector<float>& light) {
  const auto covers = [&](const Fault& fault) {
    return std::ranges::any_of(kCovers, [&](const Cover& c) { return acts(fault, c.kind, view); });
  };
  if (std::ranges::none_of(faults.faults, covers)) return;
  const std::vector<float> reflectance = patchReflectance(faults, view);
  const RectPx& p = view.patch_px;
  for (int y = std::max(0, p.y); y < std::min(view.size.height, p.y + p.height); ++y)
    for (int x = std::max(0, p.x); x < std::min(view.size.width, p.x + p.width); ++x) {
      const auto k = static_cast<std::size_t>(y - p.y) * p.width + (x - p.x);
      light[static_cast<std::size_t>(y) * view.size.width + x] *=
          reflectance[k] / static_cast<float>(view.patch_reflectance);
    }
}

}  // namespace

std::uint64_t viewKey(const FaultPlan& faults, const Fault& fault) {
  std::uint64_t key = hashSeed(faults.seed, static_cast<std::uint64_t>(fault.at.count()),
                               static_cast<std::uint64_t>(fault.kind));
  for (const char c : fault.device) key = hashSeed(key, static_cast<unsigned char>(c));
  return key;
}

double focusBlurPx(const FaultPlan& faults, const TroubledView& view) {
  double squares = 0;
  for (const Fault& fault : faults.faults) {
    if (fault.kind != FaultKind::kFocusCreep || fault.device != view.camera) continue;
    const Nanoseconds crept = std::min(view.run_time - fault.at, fault.duration);
    const double blur = fault.amount * std::max(toSeconds(crept), 0.0) / kDayS;
    squares += blur * blur;
  }
  return std::min(std::sqrt(squares), kBlurMost * std::min(view.size.width, view.size.height));
}

double fogShare(const FaultPlan& faults, const TroubledView& view) {
  double clear = 1;
  for (const Fault& fault : faults.faults) {
    if (!acts(fault, FaultKind::kCondensation, view)) continue;
    const double past = pastShare(fault, view);
    const double left = fault.duration < kFaultForEver ? swollen(1 - past) : 1;
    clear *= 1 - fault.amount * std::min(swollen(past), left);
  }
  return 1 - clear;
}

std::vector<float> patchReflectance(const FaultPlan& faults, const TroubledView& view) {
  const RectPx& p = view.patch_px;
  std::vector<float> reflectance(static_cast<std::size_t>(p.width) * p.height,
                                 static_cast<float>(view.patch_reflectance));
  for (const Fault& fault : faults.faults)
    for (const Cover& with : kCovers)
      if (acts(fault, with.kind, view))
        cover(with, fault.amount * (with.at_once ? 1 : swollen(pastShare(fault, view))),
              viewKey(faults, fault), p, reflectance);
  return reflectance;
}

void troubleView(const FaultPlan& faults, const TroubledView& view, std::vector<float>& light) {
  coverPatch(faults, view, light);
  for (const Fault& fault : faults.faults)
    if (acts(fault, FaultKind::kInsect, view))
      drawInsect(light, view.size,
                 insectAt(view.size, viewKey(faults, fault), pastShare(fault, view)));
  for (const Fault& fault : faults.faults)
    if (acts(fault, FaultKind::kHand, view))
      drawHand(light, view.white_card(), view.size, viewKey(faults, fault));
  blurMosaic(light, view.size, focusBlurPx(faults, view));
  fogMosaic(light, view.size, fogShare(faults, view));
}

}  // namespace patina::devices::twin
