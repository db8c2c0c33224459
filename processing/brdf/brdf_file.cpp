// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/brdf_file.h"

#include <array>
#include <cmath>
#include <utility>

#include "processing/image/atomic_file.h"
#include "processing/image/picture_file.h"

namespace patina::brdf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "patina.brdf-set/1";
constexpr std::array<std::pair<Model, const char*>, 5> kModels{
    {{Model::kLambert, "lambert"},
     {Model::kWard, "ward"},
     {Model::kWardAnisotropic, "ward-anisotropic"},
     {Model::kTorranceSparrow, "torrance-sparrow"},
     {Model::kGgx, "ggx"}}};
constexpr std::array<std::pair<RoughnessKind, const char*>, 3> kKinds{
    {{RoughnessKind::kAlpha, "alpha"},
     {RoughnessKind::kPerceptual, "perceptual"},
     {RoughnessKind::kSigma, "sigma"}}};
constexpr float kSlightlyBelowZero = -1e-3f;  // of half floats and resampling
constexpr float kReflectanceMost = 1e4f;      // pictures of unknown scale may lie above 1, not here
constexpr float kNormalLengthOff = 0.05f;

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kBadData, what); }

template <class Pairs>
std::string namesOf(const Pairs& pairs) {
  std::string names;
  for (const auto& pair : pairs) names.append(names.empty() ? "" : ", ").append(pair.second);
  return names;
}

struct Range {
  float low, high;
};

void checkValues(const Image<float>& map, const std::string& name, Range range) {
  const int width = map.width(), channels = map.channels();
  for (std::size_t i = 0; i < map.texels().size(); ++i) {
    const float v = map.texels()[i];
    if (v >= range.low && v <= range.high) continue;
    const std::size_t texel = i / static_cast<std::size_t>(channels);
    refuse(name + " holds " + std::to_string(v) + " at (" +
           std::to_string(texel % static_cast<std::size_t>(width)) + ", " +
           std::to_string(texel / static_cast<std::size_t>(width)) + "); it lies between " +
           std::to_string(range.low) + " and " + std::to_string(range.high));
  }
}

void checkNormals(const Image<float>& normal, const std::string& name) {
  for (int y = 0; y < normal.height(); ++y)
    for (int x = 0; x < normal.width(); ++x) {
      const auto n = normal.view().texel(x, y);
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (!(std::abs(length - 1) <= kNormalLengthOff))
        refuse(name + " has a normal of length " + std::to_string(length) + " at (" +
               std::to_string(x) + ", " + std::to_string(y) +
               "); they are unit vectors, x right, y up, z to the camera");
    }
}

void checkShape(const Image<float>& map, const std::string& name, SizePx size, bool colour,
                bool grey) {
  if (map.size() != size)
    refuse(name + " is " + std::to_string(map.width()) + "x" + std::to_string(map.height()) +
           ", Diffuse " + std::to_string(size.width) + "x" + std::to_string(size.height));
  if (!((colour && map.channels() == 3) || (grey && map.channels() == 1)))
    refuse(name + " has " + std::to_string(map.channels()) + " channels");
}

// `where`: what messages begin with.
void checkMaps(const BrdfMaps& maps, const BrdfSetInfo& info, const std::string& where) {
  if (maps.diffuse.empty()) refuse(where + "Diffuse is missing");
  const SizePx size = maps.diffuse.size();
  const Range reflectance{kSlightlyBelowZero, kReflectanceMost};
  checkShape(maps.diffuse, where + "Diffuse", size, true, true);
  checkValues(maps.diffuse, where + "Diffuse", reflectance);
  if (info.model != Model::kLambert) {
    if (maps.specular.empty()) refuse(where + "Specular is missing");
    if (maps.roughness.empty()) refuse(where + "Roughness is missing");
    checkShape(maps.specular, where + "Specular", size, true, true);
    checkValues(maps.specular, where + "Specular", reflectance);
    checkShape(maps.roughness, where + "Roughness", size, false, true);
    checkValues(maps.roughness, where + "Roughness",
                {kSlightlyBelowZero, info.roughness == RoughnessKind::kSigma ? 10.0f : 1.001f});
  }
  if (!maps.normal.empty()) {
    checkShape(maps.normal, where + "Normal", size, true, false);
    checkNormals(maps.normal, where + "Normal");
  }
  for (const auto& [name, map] : maps.extra) {
    checkShape(map, where + name, size, true, true);
    checkValues(map, where + name, {-1e30f, 1e30f});
  }
}

Manifest manifestOf(const BrdfSetInfo& info) {
  Manifest manifest;
  manifest.text("format", kFormat).text("model", nameOf(info.model));
  manifest.text("roughness", nameOf(info.roughness));
  for (const auto& [key, value] : info.facts.all())
    if (!manifest.has(key) && key != "times" && key != "maps") manifest.set(key, value);
  return manifest;
}

void writeMapsInto(const fs::path& folder, const BrdfSetInfo& info, const BrdfMaps& maps,
                   std::optional<double> time) {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const Image<float>& map) {
    if (map.empty()) return;
    fs::create_directories((folder / name).parent_path());
    writeExr(folder / (name + ".exr"), map.view());
    names.push_back(name);
  };
  write("Diffuse", maps.diffuse);
  write("Specular", maps.specular);
  write("Roughness", maps.roughness);
  write("Normal", maps.normal);
  for (const auto& [name, map] : maps.extra) write(name, map);
  Manifest manifest = manifestOf(info);
  manifest.set("maps", names);
  if (time) manifest.number("time", *time);
  writeFileAtomically(folder / "manifest.json", manifest.json());
}

void writeFolder(const fs::path& folder, const BrdfSetInfo& info, const BrdfMaps& maps,
                 std::optional<double> time) {
  writeFolderAtomically(
      folder, [&](const fs::path& temporary) { writeMapsInto(temporary, info, maps, time); });
}

void checkBeforeWriting(const BrdfMaps& maps, const BrdfSetInfo& info) {
  try {
    checkMaps(maps, info, "");
  } catch (const ProcessingError& e) {
    throw ProcessingError(Exit::kUsage, std::string("no BRDF set: ") + e.what());
  }
}

Image<float> readMap(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  try {
    return readPicture(file).linear;
  } catch (const ProcessingError& e) {
    throw ProcessingError(e.exit(), file.string() + ": " + e.what());
  }
}

}  // namespace

std::string nameOf(Model model) {
  for (const auto& [value, name] : kModels)
    if (value == model) return name;
  failCheck("a model has a name", __FILE__, __LINE__);
}

std::string nameOf(RoughnessKind kind) {
  for (const auto& [value, name] : kKinds)
    if (value == kind) return name;
  failCheck("a roughness has a name", __FILE__, __LINE__);
}

Model modelOf(const std::string& name) {
  for (const auto& [value, known] : kModels)
    if (name == known) return value;
  refuse("there is no model '" + name + "'; there are " + namesOf(kModels));
}

RoughnessKind roughnessKindOf(const std::string& name) {
  for (const auto& [value, known] : kKinds)
    if (name == known) return value;
  refuse("there is no roughness '" + name + "'; there are " + namesOf(kKinds));
}

fs::path brdfStepFolder(const fs::path& set, int step) {
  std::string name = std::to_string(step);
  name.insert(0, name.size() < 4 ? 4 - name.size() : 0, '0');
  return set / ("t" + name);
}

bool brdfStepIsThere(const fs::path& set, int step) {
  std::error_code error;
  return fs::is_regular_file(brdfStepFolder(set, step) / "manifest.json", error);
}

BrdfSetInfo readBrdfSetInfo(const fs::path& set) {
  BrdfSetInfo info;
  info.facts = readManifest(set);
  const std::string where = (set / "manifest.json").string() + ": ";
  if (info.facts.text("format") != kFormat)
    refuse(where + "no BRDF set: `format` is not " + kFormat);
  info.model = modelOf(info.facts.text("model").value_or("(none)"));
  info.roughness = roughnessKindOf(info.facts.text("roughness").value_or("alpha"));
  if (info.facts.has("times")) {
    const auto times = info.facts.numbers("times");
    if (!times || times->empty()) refuse(where + "`times` is a list of numbers");
    for (std::size_t i = 1; i < times->size(); ++i)
      if (!((*times)[i] > (*times)[i - 1])) refuse(where + "`times` do not rise");
    info.times = *times;
  }
  for (int step = 0; step < static_cast<int>(info.times.size()); ++step)
    if (!brdfStepIsThere(set, step)) refuse(brdfStepFolder(set, step).string() + " is missing");
  const fs::path first = (info.times.empty() ? set : brdfStepFolder(set, 0)) / "Diffuse.exr";
  std::error_code error;
  if (!fs::is_regular_file(first, error)) refuse(first.string() + " is missing");
  info.size = readPictureHeader(readFile(first)).size;
  return info;
}

BrdfMaps readBrdfMaps(const fs::path& set, const BrdfSetInfo& info, int step) {
  PATINA_CHECK(step >= 0 && step < info.steps());
  const fs::path folder = info.times.empty() ? set : brdfStepFolder(set, step);
  BrdfMaps maps;
  maps.diffuse = readMap(folder / "Diffuse.exr");
  maps.specular = readMap(folder / "Specular.exr");
  maps.roughness = readMap(folder / "Roughness.exr");
  maps.normal = readMap(folder / "Normal.exr");
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".exr" || name == "Diffuse" || name == "Specular" ||
        name == "Roughness" || name == "Normal")
      continue;
    maps.extra[name] = readMap(entry.path());
  }
  checkMaps(maps, info, folder.string() + ": ");
  return maps;
}

int nearestStep(const BrdfSetInfo& info, double time) {
  int nearest = 0;
  for (int step = 1; step < static_cast<int>(info.times.size()); ++step)
    if (std::abs(info.times[static_cast<std::size_t>(step)] - time) <
        std::abs(info.times[static_cast<std::size_t>(nearest)] - time))
      nearest = step;
  return nearest;
}

void writeBrdfSet(const fs::path& set, const BrdfSetInfo& info, const BrdfMaps& maps) {
  checkBeforeWriting(maps, info);
  if (fs::exists(set))
    throw ProcessingError(Exit::kCannotCreate, set.string() + " is there already");
  writeFolder(set, info, maps, std::nullopt);
}

void writeBrdfStep(const fs::path& set, const BrdfSetInfo& info, int step, const BrdfMaps& maps) {
  PATINA_CHECK(step >= 0 && step < static_cast<int>(info.times.size()));
  checkBeforeWriting(maps, info);
  std::error_code error;
  fs::create_directories(set, error);
  if (error)
    throw ProcessingError(Exit::kCannotCreate,
                          set.string() + " cannot be made: " + error.message());
  writeFolder(brdfStepFolder(set, step), info, maps, info.times[static_cast<std::size_t>(step)]);
}

void finishBrdfSet(const fs::path& set, const BrdfSetInfo& info) {
  for (int step = 0; step < static_cast<int>(info.times.size()); ++step)
    if (!brdfStepIsThere(set, step))
      throw ProcessingError(Exit::kUsage, brdfStepFolder(set, step).string() + " is not written");
  Manifest manifest = manifestOf(info);
  manifest.set("times", info.times);
  writeFileAtomically(set / "manifest.json", manifest.json());
}

}  // namespace patina::brdf
