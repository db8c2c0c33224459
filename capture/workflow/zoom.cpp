// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/zoom.h"

#include <cmath>
#include <cstdio>

#include "capture/workflow/failure.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

constexpr double kFocalShare = 0.01, kFocusShare = 0.05;

void agree(double& known, std::string& known_of, double said, const std::string& name, double share,
           const char* unit) {
  if (!(said > 0)) return;
  if (!(known > 0)) {
    known = said;
    known_of = name;
    return;
  }
  if (std::abs(said - known) <= share * known) return;
  char text[96];
  std::snprintf(text, sizeof text, " was taken at %.3g %s and ", said, unit);
  char other[48];
  std::snprintf(other, sizeof other, " at %.3g %s", known, unit);
  throw WorkflowError(Exit::kBadData, name + text + known_of + other +
                                          ": leave zoom and focus alone while you shoot them");
}

}  // namespace

Zoom zoomOf(std::span<const std::byte> picture_file) {
  const PictureMetadata about = readMetadata(picture_file);
  return {about.focal_mm.value_or(0), about.focus_m.value_or(0)};
}

void CommonZoom::add(const Zoom& zoom, const std::string& name) {
  agree(zoom_.focal_mm, focal_of_, zoom.focal_mm, name, kFocalShare, "mm");
  agree(zoom_.focus_m, focus_of_, zoom.focus_m, name, kFocusShare, "m of distance");
}

void addZoom(Facts& values, const Zoom& zoom) {
  if (zoom.focal_mm > 0) values.number("focal_mm", zoom.focal_mm);
  if (zoom.focus_m > 0) values.number("focus_m", zoom.focus_m);
}

}  // namespace patina::workflow
