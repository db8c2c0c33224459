// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/rectification.h"

#include <algorithm>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kSideMost = 32'768;
constexpr int kRimSteps = 32;

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

void RectifyOptions::check() const {
  const auto refuse = [](const std::string& what) { throw CalibrationError(Exit::kUsage, what); };
  if (!(region.width > 0 && region.height > 0) || !std::isfinite(region.left) ||
      !std::isfinite(region.bottom))
    refuse("a region of " + numberText(region.width) + " x " + numberText(region.height) +
           " mm: both above 0");
  if (!(texels_per_mm >= 1e-3 && texels_per_mm <= 1e5))
    refuse(numberText(texels_per_mm) + " texels a millimetre: 0.001 to 100000");
  if (!(std::max(region.width, region.height) * texels_per_mm <= kSideMost))
    refuse("a texture of " + numberText(region.width * texels_per_mm) + " x " +
           numberText(region.height * texels_per_mm) + " texels: at most " +
           std::to_string(kSideMost) +
           " each way; take a smaller region or fewer texels a millimetre");
}

SizePx sizeOf(const RectifyOptions& options) {
  const auto texels = [&](double mm) {
    return std::max(1, static_cast<int>(std::lround(mm * options.texels_per_mm)));
  };
  return {texels(options.region.width), texels(options.region.height)};
}

RegionMm seenRegion(const Lens& lens, const View& view) {
  const double right = lens.size.width - 1, bottom = lens.size.height - 1;
  std::vector<PlacePx> rim{{right / 2, bottom / 2}};
  for (int i = 0; i <= kRimSteps; ++i) {
    const double x = right * i / kRimSteps, y = bottom * i / kRimSteps;
    for (const PlacePx& p : {PlacePx{x, 0}, PlacePx{x, bottom}, PlacePx{0, y}, PlacePx{right, y}})
      rim.push_back(p);
  }
  const std::vector<PointMm> places = planePlaces(lens, view, rim);
  const PointMm middle = places[0];
  if (std::isnan(middle.x))
    throw CalibrationError(Exit::kBadData, "the middle of the picture does not see the plane");
  // A box around the middle, grown in its own shape until a place of the rim is within: the shape
  // is that of the whole rim.
  double half_width = 0, half_height = 0;
  for (const PointMm& p : places) {
    if (std::isnan(p.x)) continue;
    half_width = std::max(half_width, std::abs(p.x - middle.x));
    half_height = std::max(half_height, std::abs(p.y - middle.y));
  }
  double share = 1;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (!std::isnan(places[i].x))
      share = std::min(share, std::max(std::abs(places[i].x - middle.x) / half_width,
                                       std::abs(places[i].y - middle.y) / half_height));
  half_width *= share;
  half_height *= share;
  return {middle.x - half_width, middle.y - half_height, 2 * half_width, 2 * half_height};
}

double naturalTexelsPerMm(const Lens& lens, const View& view, const RegionMm& region) {
  const double x = region.left + region.width / 2, y = region.bottom + region.height / 2;
  const double step = std::min(region.width, region.height) * 1e-3;
  const std::vector<PointMm> places{{x, y, 0}, {x + step, y, 0}, {x, y + step, 0}};
  const std::vector<PlacePx> seen = project(lens, view, places);
  const double across = std::hypot(seen[1].x - seen[0].x, seen[1].y - seen[0].y) / step;
  const double up = std::hypot(seen[2].x - seen[0].x, seen[2].y - seen[0].y) / step;
  const double finer = std::max(across, up);
  if (!(finer > 0))
    throw CalibrationError(Exit::kUsage, "the camera does not see the middle of the region");
  return finer;
}

PixelMap rectification(const Lens& lens, const View& view, const RectifyOptions& options) {
  lens.check();
  options.check();
  const SizePx size = sizeOf(options);
  PixelMap map{Image<float>(size.width, size.height, 2)};
  const ImageView<float> to = map.source_px.view();
  const double step = 1 / options.texels_per_mm,
               top = options.region.bottom + options.region.height;
  forEachRow(size.height, std::int64_t{200} * size.width, [&](int y) {
    std::vector<PointMm> places(static_cast<std::size_t>(size.width));
    for (int x = 0; x < size.width; ++x)
      places[static_cast<std::size_t>(x)] = {options.region.left + (x + 0.5) * step,
                                             top - (y + 0.5) * step, 0};
    const std::vector<PlacePx> seen = project(lens, view, places);
    for (int x = 0; x < size.width; ++x) {
      to.at(x, y, 0) = static_cast<float>(seen[static_cast<std::size_t>(x)].x);
      to.at(x, y, 1) = static_cast<float>(seen[static_cast<std::size_t>(x)].y);
    }
  });
  return map;
}

}  // namespace patina::calibration
