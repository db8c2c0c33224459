// SPDX-License-Identifier: GPL-3.0-or-later
// BRDF sets: a folder of float EXR maps with a manifest.json.
//
//   one time        SET/manifest.json, SET/Diffuse.exr, Specular.exr, Roughness.exr, Normal.exr ...
//   several times   SET/manifest.json with `times`, SET/t0000/manifest.json, SET/t0000/Diffuse.exr
//   ...
//
// Each tNNNN is a set of one time by itself and appears whole, so that a fit that was stopped goes
// on after its last whole step; SET/manifest.json comes last. Row 0 is the top row (y up: the
// largest y). Diffuse and specular are linear reflectances, normals unit vectors x right, y up,
// z to the camera.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "processing/brdf/manifest.h"
#include "processing/image/image.h"

namespace patina::brdf {

// What Specular and Roughness are parameters of.
enum class Model {
  kLambert,          // Diffuse alone
  kWard,             // Roughness = alpha of Ward's Gaussian
  kWardAnisotropic,  // Roughness across, extra RoughnessY, extra Tangent (unit, along Roughness)
  kTorranceSparrow,  // simplified (Meister et al. 2021, eq. 2)
  kGgx
};
enum class RoughnessKind {
  kAlpha,
  kPerceptual,  // sqrt(alpha)
  kSigma        // of the simplified Torrance-Sparrow lobe
};
std::string nameOf(Model model);  // "lambert" "ward" "ward-anisotropic" "torrance-sparrow" "ggx"
std::string nameOf(RoughnessKind kind);  // "alpha" "perceptual" "sigma"
Model modelOf(const std::string& name);  // throws ProcessingError(kBadData) naming those there are
RoughnessKind roughnessKindOf(const std::string& name);

// Maps of one time, all of one size. Empty: not there.
struct BrdfMaps {
  Image<float> diffuse;    // [h][w][3] (or 1), required
  Image<float> specular;   // [h][w][1 or 3]
  Image<float> roughness;  // [h][w][1]
  Image<float> normal;     // [h][w][3]
  // By file name: "Height" (mm), "degree", "Confidence" ... [h][w][1 or 3]. Those in folders
  // ("residual/00") are written, and left to whoever asks for them.
  std::map<std::string, Image<float>> extra;
};

struct BrdfSetInfo {
  Model model = Model::kGgx;
  RoughnessKind roughness = RoughnessKind::kAlpha;
  std::vector<double>
      times;       // rising; empty: one set without `times`, whose maps lie in the folder
  SizePx size;     // filled by the reader
  Manifest facts;  // all of manifest.json; a writer adds its own facts here
  int steps() const { return times.empty() ? 1 : static_cast<int>(times.size()); }
};

// Reads and checks the manifest; every step's folder must be there. Throws
// ProcessingError(kBadData).
BrdfSetInfo readBrdfSetInfo(const std::filesystem::path& set);
// `step` in [0, steps()). Throws ProcessingError(kBadData): a missing map, sizes that differ, NaN,
// negative reflectance, roughness or normals that cannot be.
BrdfMaps readBrdfMaps(const std::filesystem::path& set, const BrdfSetInfo& info, int step = 0);
// The step nearest to `time`; 0 without times.
int nearestStep(const BrdfSetInfo& info, double time);

// One set of one time; the folder appears whole. Throws ProcessingError(kCannotCreate) when `set`
// is there already, kUsage for maps that readBrdfMaps() would refuse.
void writeBrdfSet(const std::filesystem::path& set, const BrdfSetInfo& info, const BrdfMaps& maps);

// Several times: each step as it is ready, in any order and over several processes, then finish.
// A step that is there already is replaced.
void writeBrdfStep(const std::filesystem::path& set, const BrdfSetInfo& info, int step,
                   const BrdfMaps& maps);
bool brdfStepIsThere(const std::filesystem::path& set, int step);
std::filesystem::path brdfStepFolder(const std::filesystem::path& set, int step);  // SET/t0000
// Writes SET/manifest.json. Throws ProcessingError(kUsage) when a step is missing.
void finishBrdfSet(const std::filesystem::path& set, const BrdfSetInfo& info);

}  // namespace patina::brdf
