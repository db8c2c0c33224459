// SPDX-License-Identifier: GPL-3.0-or-later
// ST-BRDF sets: a folder with one EXR for each map and power of time (NAME-k.exr holds coefficient
// k) and a manifest.json.
//
//   manifest.json   format patina.stbrdf-set/1, degree, basis, model, roughness, maps, ranges
//   Diffuse-0.exr Diffuse-1.exr ... Specular-k Roughness-k, and extra maps: Normal-k Height-k ...
//
// Folders without a manifest (Meister et al. 2021; half floats) are read as monomials in [0,1] of
// the degree that Diffuse has. Written are float32, so nothing is lost.
#pragma once

#include <filesystem>

#include "processing/image/progress.h"
#include "processing/stbrdf/stbrdf_set.h"

namespace patina::stbrdf {

// Whether a folder holds coefficients over time: Diffuse-0.exr is there.
bool isStbrdfSet(const std::filesystem::path& folder);

// Throws ProcessingError(kBadData): no set, a coefficient missing, sizes that differ, a value that
// is no number, and maps that leave their range by more than its width.
StbrdfSet readStbrdfSet(const std::filesystem::path& folder, Progress& progress);

// The folder appears whole or not at all. Throws ProcessingError(kCannotCreate) when it is there
// already, kUsage for a set that the reader would refuse.
void writeStbrdfSet(const std::filesystem::path& folder, const StbrdfSet& set, Progress& progress);

// What both of them check.
void checkSet(const StbrdfSet& set, const std::string& where);

}  // namespace patina::stbrdf
