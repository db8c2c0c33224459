// SPDX-License-Identifier: GPL-3.0-or-later
// Where samples over time come from:
//
//   a folder of steps      FOLDER/t0000/Diffuse.exr ... (brdf/brdf_file.h)
//   several sets           one folder each, with Diffuse.exr and a manifest.json that tells `time`
//   EXR sequences          FOLDER/Diffuse.0000.exr, FOLDER/Diffuse.0001.exr ...
//
// Times come from `times` of the folder's manifest, else from `time` of each step's; where nothing
// tells them, steps are evenly spaced. Times beyond [0,1] (seconds, say) are stretched over [0,1].
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "processing/brdf/manifest.h"
#include "processing/image/progress.h"
#include "processing/stbrdf/samples.h"

namespace patina::stbrdf {

struct SampleSet {
  std::vector<double> times;  // in [0,1]
  bool times_told = false;    // else evenly spaced
  std::string model = "ggx", roughness = "alpha";
  brdf::Manifest facts;  // of the first step, without time
  std::map<std::string, std::vector<std::filesystem::path>> maps;  // by name: a file a step
};

// Lists files, reads manifests. Throws ProcessingError(kBadData): nothing there, a map that a step
// lacks, times that do not match.
SampleSet openSamples(const std::vector<std::filesystem::path>& inputs);

// One map of all steps, range chosen, checked. Files are decoded on all threads.
TimeSamples readSamples(const SampleSet& set, const std::string& name, Progress& progress);

}  // namespace patina::stbrdf
