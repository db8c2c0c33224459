// SPDX-License-Identifier: GPL-3.0-or-later
// From a folder of pictures with a light file to a BRDF set, judged on lights that were left out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/lights_file.h"
#include "processing/brdf/light_residual.h"
#include "processing/brdf/multi_light_fit.h"

namespace patina::workflow {

struct ReflectanceRequest {
  std::filesystem::path folder, lights;
  std::vector<int> leave_out;  // numbers in the light file, from 1
  brdf::MultiLightOptions fit{};
  bool residual = true;  // what the model leaves, over the lights, for pictures of 8 and 16 bits
  std::string command, version;
};

// Over all pictures left out and all their pixels.
struct Likeness {
  double psnr_db = 0, ssim = 0;
};
struct LeftOutScores {
  int pictures = 0;
  bool stored = false;  // of stored (sRGB) values; else of linear ones
  Likeness model;       // the reflectance alone
  std::optional<Likeness> with_residual;
  Likeness lambert;     // fitted to the same pictures
  Likeness polynomial;  // a polynomial texture map of six terms, likewise
};
struct ReflectanceOutcome {
  brdf::MultiLightFit fit;
  std::optional<brdf::LightResidual> residual;
  std::optional<LeftOutScores> left_out;
  std::vector<std::string> pictures;  // used, by name
  std::vector<std::string> input_sha256s;
  std::vector<std::string> warnings;
};

// Throws WorkflowError(kBadData) for a light file that names a picture which is not there, pictures
// that differ in size; kUsage for a number left out that the file has not. Directions that are not
// of length 1 are made so, with a warning. Throws ProcessingError as fitManyLights() does.
ReflectanceOutcome fitReflectance(const ReflectanceRequest& request, Progress& progress);

// The folder appears whole. The residual lies in it as residual/NN.exr.
void writeReflectance(const std::filesystem::path& set, const ReflectanceRequest& request,
                      const ReflectanceOutcome& outcome);

// One picture of the set under a distant light: linear, or, where the set holds a residual,
// of stored values. `step`: of a set with several times.
struct SetPicture {
  Image<float> picture;
  bool stored = false;
};
SetPicture pictureOfSet(const std::filesystem::path& set, int step, const brdf::Vec3& light);

}  // namespace patina::workflow
