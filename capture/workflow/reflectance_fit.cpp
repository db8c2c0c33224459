// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/reflectance_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "capture/workflow/failure.h"
#include "processing/brdf/picture_score.h"
#include "processing/brdf/polynomial_map.h"
#include "processing/brdf/relight.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/image/sha256.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr double kUnitOff = 1e-3;

// A picture as it was stored and as light.
struct LitPicture {
  LightDirection light;
  brdf::Vec3 direction;
  Image<float> linear;
  bool encoded = false;
  bool left_out = false;
};

brdf::Vec3 unitOf(const LightDirection& light, int& not_unit) {
  const auto& [x, y, z] = light.direction;
  const double length = std::sqrt(x * x + y * y + z * z);
  if (std::abs(length - 1) > kUnitOff) ++not_unit;
  return {static_cast<float>(x / length), static_cast<float>(y / length),
          static_cast<float>(z / length)};
}

void markLeftOut(std::vector<LitPicture>& pictures, const std::vector<int>& numbers) {
  for (const int number : numbers) {
    if (number < 1 || number > static_cast<int>(pictures.size()))
      throw WorkflowError(Exit::kUsage, "--leave-out names light " + std::to_string(number) +
                                            "; the light file has 1 to " +
                                            std::to_string(pictures.size()));
    pictures[static_cast<std::size_t>(number - 1)].left_out = true;
  }
}

std::vector<LitPicture> load(const ReflectanceRequest& request, ReflectanceOutcome& outcome,
                             Progress& progress) {
  std::vector<LitPicture> pictures;
  int not_unit = 0;
  for (const LightDirection& light : readLights(request.lights)) {
    const fs::path file = request.folder / light.file;
    std::error_code error;
    if (!fs::is_regular_file(file, error))
      throw WorkflowError(Exit::kBadData, request.lights.string() + " names " + light.file +
                                              ", which is not in " + request.folder.string());
    pictures.push_back({light, unitOf(light, not_unit), {}, false, false});
  }
  if (not_unit > 0)
    outcome.warnings.push_back(std::to_string(not_unit) + " of " + std::to_string(pictures.size()) +
                               " lights of " + request.lights.string() +
                               " are not of length 1: only their directions are used");
  markLeftOut(pictures, request.leave_out);
  progress.begin("reading pictures", static_cast<std::int64_t>(pictures.size()));
  for (LitPicture& one : pictures) {
    const Bytes bytes = readFile(request.folder / one.light.file);
    outcome.input_sha256s.push_back(sha256(bytes).hex());
    Picture picture = decodePicture(bytes);
    one.encoded = picture.format == PictureFormat::kJpeg || picture.format == PictureFormat::kPng ||
                  picture.format == PictureFormat::kTiff;
    one.linear = std::move(picture.linear);
    if (one.linear.size() != pictures[0].linear.size())
      throw WorkflowError(Exit::kBadData, one.light.file + " is " +
                                              std::to_string(one.linear.width()) + "x" +
                                              std::to_string(one.linear.height()) +
                                              " and differs from " + pictures[0].light.file);
    progress.step();
  }
  return pictures;
}

Image<float> storedOf(const Image<float>& linear, bool encoded) {
  Image<float> out = linear;
  if (encoded)
    for (float& v : out.texels()) v = srgbFromLinear(std::clamp(v, 0.0f, 1.0f));
  return out;
}

std::vector<brdf::FitSample> samplesOf(const std::vector<LitPicture>& pictures) {
  std::vector<brdf::FitSample> samples;
  for (const LitPicture& one : pictures) {
    if (one.left_out) continue;
    brdf::FitSample sample;
    sample.picture = one.linear.view();
    sample.light.direction = one.direction;
    samples.push_back(sample);
  }
  return samples;
}

Image<float> modelUnder(const brdf::BrdfMaps& maps, brdf::Model model, const brdf::Vec3& l,
                        bool encoded) {
  brdf::BrdfSetInfo info;
  info.model = model;
  if (model == brdf::Model::kTorranceSparrow) info.roughness = brdf::RoughnessKind::kSigma;
  brdf::SurfaceLight light;
  light.direction = l;
  return storedOf(brdf::relight(maps, info, light), encoded);
}

void subtract(Image<float>& from, const Image<float>& what) {
  for (std::size_t i = 0; i < from.texels().size(); ++i) from.texels()[i] -= what.texels()[i];
}
void add(Image<float>& to, const Image<float>& what) {
  for (std::size_t i = 0; i < to.texels().size(); ++i) to.texels()[i] += what.texels()[i];
}

brdf::LightResidual residualOf(const std::vector<LitPicture>& pictures, const brdf::BrdfMaps& maps,
                               brdf::Model model, Progress& progress) {
  std::vector<Image<float>> off;
  std::vector<brdf::Vec3> lights;
  for (const LitPicture& one : pictures) {
    if (one.left_out) continue;
    Image<float> rest = storedOf(one.linear, one.encoded);
    subtract(rest, modelUnder(maps, model, one.direction, one.encoded));
    off.push_back(std::move(rest));
    lights.push_back(one.direction);
  }
  return brdf::fitResidual(std::move(off), std::move(lights), progress);
}

// Sums over the pictures left out.
class Judge {
 public:
  void add(const Image<float>& truth, const Image<float>& seen) {
    square_ += brdf::meanSquareError(truth.view(), seen.view());
    ssim_ += brdf::ssim(truth.view(), seen.view());
    ++pictures_;
  }
  Likeness likeness() const { return {brdf::psnrDb(square_ / pictures_), ssim_ / pictures_}; }

 private:
  double square_ = 0, ssim_ = 0;
  int pictures_ = 0;
};

brdf::PolynomialMap polynomialOf(const std::vector<LitPicture>& pictures) {
  std::vector<Image<float>> stored;
  std::vector<brdf::Vec3> lights;
  for (const LitPicture& one : pictures) {
    if (one.left_out) continue;
    stored.push_back(storedOf(one.linear, one.encoded));
    lights.push_back(one.direction);
  }
  std::vector<ImageView<const float>> views;
  for (const Image<float>& picture : stored)
    views.push_back(ImageView<const float>(picture.view()));
  return brdf::fitPolynomialMap(views, lights);
}

LeftOutScores judge(const std::vector<LitPicture>& pictures, const ReflectanceRequest& request,
                    const ReflectanceOutcome& outcome, Progress& progress) {
  brdf::MultiLightOptions matt = request.fit;
  matt.model = brdf::Model::kLambert;
  const brdf::MultiLightFit lambert = brdf::fitManyLights(samplesOf(pictures), matt, {}, progress);
  const brdf::PolynomialMap polynomial = polynomialOf(pictures);
  Judge of_model, of_both, of_lambert, of_polynomial;
  LeftOutScores scores;
  for (const LitPicture& one : pictures) {
    if (!one.left_out) continue;
    const Image<float> truth = storedOf(one.linear, one.encoded);
    Image<float> seen = modelUnder(outcome.fit.maps, request.fit.model, one.direction, one.encoded);
    of_model.add(truth, seen);
    if (outcome.residual) {
      add(seen, brdf::residualUnder(*outcome.residual, one.direction));
      of_both.add(truth, seen);
    }
    of_lambert.add(truth,
                   modelUnder(lambert.maps, brdf::Model::kLambert, one.direction, one.encoded));
    of_polynomial.add(truth, brdf::polynomialUnder(polynomial, one.direction));
    scores.stored = one.encoded;
    ++scores.pictures;
  }
  scores.model = of_model.likeness();
  if (outcome.residual) scores.with_residual = of_both.likeness();
  scores.lambert = of_lambert.likeness();
  scores.polynomial = of_polynomial.likeness();
  return scores;
}

std::string residualName(std::size_t j) {
  char name[32];
  std::snprintf(name, sizeof name, "residual/%02zu", j);
  return name;
}

void addFacts(brdf::BrdfSetInfo& info, const ReflectanceRequest& request,
              const ReflectanceOutcome& outcome) {
  info.facts.text("command", request.command).text("version", request.version);
  info.facts.set("pictures", outcome.pictures);
  info.facts.set("input_sha256s", outcome.input_sha256s);
  info.facts.number("residual_rms", outcome.fit.report.residual_rms);
  if (!outcome.residual) return;
  const brdf::LightResidual& residual = *outcome.residual;
  std::vector<double> lights;
  for (const brdf::Vec3& l : residual.lights) lights.insert(lights.end(), {l.x, l.y, l.z});
  info.facts.text("residual",
                  "stored = srgb(model) + sum_j exp(-|l - l_j|^2 / (2 width^2)) w_j: "
                  "for pictures between these lights, no reflectance");
  info.facts.set("residual_lights", lights);
  info.facts.number("residual_width", residual.width).number("residual_ridge", residual.ridge);
}

}  // namespace

ReflectanceOutcome fitReflectance(const ReflectanceRequest& request, Progress& progress) {
  ReflectanceOutcome outcome;
  const std::vector<LitPicture> pictures = load(request, outcome, progress);
  for (const LitPicture& one : pictures)
    if (!one.left_out) outcome.pictures.push_back(one.light.file);
  const std::vector<brdf::FitSample> samples = samplesOf(pictures);
  outcome.fit = brdf::fitManyLights(samples, request.fit, {}, progress);
  if (request.residual && pictures[0].encoded)
    outcome.residual = residualOf(pictures, outcome.fit.maps, request.fit.model, progress);
  if (samples.size() < pictures.size())
    outcome.left_out = judge(pictures, request, outcome, progress);
  return outcome;
}

void writeReflectance(const fs::path& set, const ReflectanceRequest& request,
                      const ReflectanceOutcome& outcome) {
  brdf::BrdfSetInfo info;
  info.model = request.fit.model;
  if (info.model == brdf::Model::kTorranceSparrow) info.roughness = brdf::RoughnessKind::kSigma;
  addFacts(info, request, outcome);
  brdf::BrdfMaps maps = outcome.fit.maps;
  if (outcome.residual)
    for (std::size_t j = 0; j < outcome.residual->weights.size(); ++j)
      maps.extra[residualName(j)] = outcome.residual->weights[j];
  brdf::writeBrdfSet(set, info, maps);
}

SetPicture pictureOfSet(const fs::path& set, int step, const brdf::Vec3& light) {
  const brdf::BrdfSetInfo info = brdf::readBrdfSetInfo(set);
  const brdf::BrdfMaps maps = brdf::readBrdfMaps(set, info, step);
  brdf::SurfaceLight from;
  from.direction = light;
  SetPicture out{brdf::relight(maps, info, from), false};
  const auto lights = info.facts.numbers("residual_lights");
  if (!lights || !info.times.empty()) return out;
  brdf::LightResidual residual;
  residual.width = info.facts.number("residual_width").value_or(0);
  if (lights->size() % 3 != 0 || !(residual.width > 0))
    throw WorkflowError(Exit::kBadData, set.string() + ": its residual is not described");
  for (std::size_t j = 0; 3 * j < lights->size(); ++j) {
    const auto at = [&](std::size_t c) { return static_cast<float>((*lights)[3 * j + c]); };
    residual.lights.push_back({at(0), at(1), at(2)});
    Image<float> weights = readPicture(set / (residualName(j) + ".exr")).linear;
    if (weights.size() != out.picture.size() || weights.channels() != out.picture.channels())
      throw WorkflowError(Exit::kBadData,
                          set.string() + ": " + residualName(j) + ".exr does not fit its maps");
    residual.weights.push_back(std::move(weights));
  }
  out.picture = storedOf(out.picture, true);
  add(out.picture, brdf::residualUnder(residual, light));
  out.stored = true;
  return out;
}

}  // namespace patina::workflow
