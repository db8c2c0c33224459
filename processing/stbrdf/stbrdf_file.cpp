// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/stbrdf_file.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "processing/image/atomic_file.h"
#include "processing/image/picture_file.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "patina.stbrdf-set/1";
constexpr int kCheckedTimes = 9;  // evenly over [0,1]

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kBadData, what); }

std::string fileName(const std::string& map, int k) {
  return map + "-" + std::to_string(k) + ".exr";
}

// NAME-k.exr of a folder: the highest k a name.
std::map<std::string, int> powersIn(const fs::path& folder) {
  std::map<std::string, int> powers;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string stem = entry.path().stem().string();
    const std::size_t dash = stem.rfind('-');
    if (entry.path().extension() != ".exr" || dash == std::string::npos || dash == 0) continue;
    const std::string digits = stem.substr(dash + 1);
    if (digits.empty() || digits.size() > 2 ||
        digits.find_first_not_of("0123456789") != std::string::npos)
      continue;
    int& highest = powers.try_emplace(stem.substr(0, dash), 0).first->second;
    highest = std::max(highest, std::stoi(digits));
  }
  if (error) refuse(folder.string() + " cannot be read: " + error.message());
  return powers;
}

// Names, degree and ranges, nothing read yet.
StbrdfSet outlineWithoutManifest(const fs::path& folder) {
  StbrdfSet set;
  const auto powers = powersIn(folder);
  const auto diffuse = powers.find("Diffuse");
  if (diffuse == powers.end())
    refuse(folder.string() + " is no ST-BRDF set: it has neither manifest.json nor Diffuse-0.exr");
  set.degree = diffuse->second;
  for (const auto& [name, highest] : powers) {
    if (highest > set.degree)
      refuse((folder / fileName(name, highest)).string() + " goes beyond the degree of Diffuse, " +
             std::to_string(set.degree) + ": are coefficients of Diffuse missing?");
    set.maps.push_back({.name = name, .coefficients = {}});
  }
  return set;
}

StbrdfSet outlineOf(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "manifest.json", error)) return outlineWithoutManifest(folder);
  const std::string where = (folder / "manifest.json").string();
  StbrdfSet set;
  set.facts = brdf::readManifest(folder);
  if (set.facts.text("format") != kFormat)
    refuse(where + ": no ST-BRDF set: `format` is not " + std::string(kFormat));
  set.degree = static_cast<int>(set.facts.number("degree").value_or(-1));
  set.basis = basisNamed(set.facts.text("basis").value_or("(none)"));
  set.model = set.facts.text("model").value_or("ggx");
  set.roughness = set.facts.text("roughness").value_or("alpha");
  const auto names = set.facts.texts("maps");
  const auto ranges = set.facts.numbers("ranges");
  if (!names || names->empty()) refuse(where + ": `maps` is a list of names");
  if (ranges && ranges->size() != 2 * names->size())
    refuse(where + ": `ranges` holds two numbers for each of `maps`");
  for (std::size_t i = 0; i < names->size(); ++i) {
    const std::string& name = (*names)[i];
    if (name.empty() || name.find('/') != std::string::npos)
      refuse(std::string(where).append(": '").append(name).append("' is no name of a map"));
    TimeMap map{.name = name, .coefficients = {}};
    if (ranges) {
      map.low = static_cast<float>((*ranges)[2 * i]);
      map.high = static_cast<float>((*ranges)[2 * i + 1]);
    }
    set.maps.push_back(std::move(map));
  }
  return set;
}

Image<float> readCoefficient(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    refuse(file.string() + " is missing: the set lacks a coefficient");
  try {
    return readPicture(file).linear;
  } catch (const ProcessingError& e) {
    throw ProcessingError(e.exit(), file.string() + ": " + e.what());
  }
}

[[noreturn]] void refuseTexel(const std::string& what, std::size_t index, const Image<float>& in) {
  const std::size_t texel = index / static_cast<std::size_t>(in.channels());
  const auto width = static_cast<std::size_t>(in.width());
  refuse(what + " at (" + std::to_string(texel % width) + ", " + std::to_string(texel / width) +
         ")");
}

void checkValues(const TimeMap& map, Basis basis, const std::string& where) {
  for (std::size_t k = 0; k < map.coefficients.size(); ++k) {
    const std::vector<float>& texels = map.coefficients[k].texels();
    const auto bad =
        std::find_if(texels.begin(), texels.end(), [](float v) { return !std::isfinite(v); });
    if (bad != texels.end())
      refuseTexel(
          where + fileName(map.name, static_cast<int>(k)) + " holds a value that is no number",
          static_cast<std::size_t>(bad - texels.begin()), map.coefficients[k]);
  }
  const float width = map.high - map.low, least = map.low - width, most = map.high + width;
  for (int i = 0; i < kCheckedTimes; ++i) {
    const double t = static_cast<double>(i) / (kCheckedTimes - 1);
    const Image<float> values = evaluate(map, basis, t, Clamp::kNone);
    const std::vector<float>& v = values.texels();
    const auto bad =
        std::find_if(v.begin(), v.end(), [&](float x) { return !(x >= least && x <= most); });
    if (bad != v.end())
      refuseTexel(where + map.name + " is " + std::to_string(*bad) + " at time " +
                      std::to_string(t).substr(0, 5) + ", far outside [" + std::to_string(map.low) +
                      ", " + std::to_string(map.high) + "],",
                  static_cast<std::size_t>(bad - v.begin()), values);
  }
}

}  // namespace

void checkSet(const StbrdfSet& set, const std::string& where) {
  if (set.degree < 0 || set.degree > kDegreeMax)
    refuse(where + "the degree is " + std::to_string(set.degree) + "; it lies between 0 and " +
           std::to_string(kDegreeMax));
  if (!set.find("Diffuse")) refuse(where + "Diffuse is missing");
  for (const TimeMap& map : set.maps) {
    if (map.coefficients.size() != static_cast<std::size_t>(set.degree) + 1)
      refuse(where + map.name + " has " + std::to_string(map.coefficients.size()) +
             " coefficients; the degree is " + std::to_string(set.degree));
    if (!(map.low < map.high)) refuse(where + map.name + " has an empty range");
    for (std::size_t k = 0; k < map.coefficients.size(); ++k) {
      const Image<float>& c = map.coefficients[k];
      if (c.size() != set.size() || c.channels() != map.coefficients[0].channels() || c.empty())
        refuse(where + fileName(map.name, static_cast<int>(k)) + " is " +
               std::to_string(c.width()) + "x" + std::to_string(c.height()) + " with " +
               std::to_string(c.channels()) + " channels, unlike the others (" +
               std::to_string(set.size().width) + "x" + std::to_string(set.size().height) + ", " +
               std::to_string(map.coefficients[0].channels()) + ")");
    }
    checkValues(map, set.basis, where);
  }
}

bool isStbrdfSet(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / fileName("Diffuse", 0), error);
}

StbrdfSet readStbrdfSet(const fs::path& folder, Progress& progress) {
  StbrdfSet set = outlineOf(folder);
  if (set.degree < 0 || set.degree > kDegreeMax) checkSet(set, folder.string() + ": ");
  const int terms = set.degree + 1, files = terms * static_cast<int>(set.maps.size());
  for (TimeMap& map : set.maps) map.coefficients.resize(static_cast<std::size_t>(terms));
  progress.begin("reading coefficients", files);
  tbb::parallel_for(0, files, [&](int i) {
    TimeMap& map = set.maps[static_cast<std::size_t>(i / terms)];
    map.coefficients[static_cast<std::size_t>(i % terms)] =
        readCoefficient(folder / fileName(map.name, i % terms));
    progress.step();
  });
  checkSet(set, folder.string() + ": ");
  return set;
}

void writeStbrdfSet(const fs::path& folder, const StbrdfSet& set, Progress& progress) {
  try {
    checkSet(set, "");
  } catch (const ProcessingError& e) {
    throw ProcessingError(Exit::kUsage, std::string("no ST-BRDF set: ") + e.what());
  }
  if (fs::exists(folder))
    throw ProcessingError(Exit::kCannotCreate, folder.string() + " is there already");
  brdf::Manifest manifest;
  manifest.text("format", kFormat).count("degree", set.degree).text("basis", nameOf(set.basis));
  manifest.text("model", set.model).text("roughness", set.roughness);
  std::vector<std::string> names;
  std::vector<double> ranges;
  for (const TimeMap& map : set.maps) {
    names.push_back(map.name);
    ranges.push_back(map.low);
    ranges.push_back(map.high);
  }
  manifest.set("maps", names).set("ranges", ranges);
  for (const auto& [key, value] : set.facts.all())
    if (!manifest.has(key)) manifest.set(key, value);

  writeFolderAtomically(folder, [&](const fs::path& temporary) {
    const int terms = set.degree + 1, files = terms * static_cast<int>(set.maps.size());
    progress.begin("writing coefficients", files);
    tbb::parallel_for(0, files, [&](int i) {
      const TimeMap& map = set.maps[static_cast<std::size_t>(i / terms)];
      writeExr(temporary / fileName(map.name, i % terms),
               map.coefficients[static_cast<std::size_t>(i % terms)].view());
      progress.step();
    });
    writeFileAtomically(temporary / "manifest.json", manifest.json());
  });
}

}  // namespace patina::stbrdf
