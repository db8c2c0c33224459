// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/samples_file.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "processing/image/picture_file.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kBadData, what); }

bool isDigits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::vector<fs::path> sortedEntries(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    out.push_back(entry.path());
  if (error) refuse(folder.string() + " cannot be read: " + error.message());
  std::sort(out.begin(), out.end());
  return out;
}

std::optional<brdf::Manifest> manifestIn(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "manifest.json", error)) return std::nullopt;
  return brdf::readManifest(folder);
}

// FOLDER/t0000 ...
std::vector<fs::path> stepFolders(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const fs::path& entry : sortedEntries(folder)) {
    const std::string name = entry.filename().string();
    if (name.size() > 1 && name[0] == 't' && isDigits(name.substr(1)) && fs::is_directory(entry))
      out.push_back(entry);
  }
  return out;
}

// NAME.0000.exr and NAME_0000.exr, by name.
std::map<std::string, std::vector<fs::path>> sequencesIn(const fs::path& folder) {
  std::map<std::string, std::vector<fs::path>> out;
  for (const fs::path& entry : sortedEntries(folder)) {
    const std::string stem = entry.stem().string();
    const std::size_t cut = stem.find_last_of("._");
    if (entry.extension() == ".exr" && cut != std::string::npos && cut > 0 &&
        isDigits(stem.substr(cut + 1)))
      out[stem.substr(0, cut)].push_back(entry);
  }
  return out;
}

void takeFacts(const brdf::Manifest& manifest, SampleSet& set) {
  set.model = manifest.text("model").value_or(set.model);
  set.roughness = manifest.text("roughness").value_or(set.roughness);
  for (const auto& [key, value] : manifest.all())
    if (key != "format" && key != "model" && key != "roughness" && key != "time" &&
        key != "times" && key != "maps")
      set.facts.set(key, value);
}

SampleSet ofSteps(const std::vector<fs::path>& steps) {
  SampleSet set;
  std::vector<double> times;
  for (const fs::path& step : steps) {
    if (const auto manifest = manifestIn(step)) {
      if (times.empty()) takeFacts(*manifest, set);
      if (const auto time = manifest->number("time")) times.push_back(*time);
    }
    for (const fs::path& entry : sortedEntries(step))
      if (entry.extension() == ".exr") set.maps[entry.stem().string()].push_back(entry);
  }
  if (!times.empty() && times.size() != steps.size())
    refuse("some steps tell their `time` in manifest.json, some do not");
  set.times = times;
  if (set.maps.find("Diffuse") == set.maps.end())
    refuse(steps[0].string() + " is no step: it has no Diffuse.exr");
  for (auto it = set.maps.begin(); it != set.maps.end();) {
    // A map that only some steps have is an error for what makes a BRDF, and left out otherwise.
    const bool needed =
        it->first == "Diffuse" || it->first == "Specular" || it->first == "Roughness";
    if (needed && it->second.size() != steps.size())
      for (const fs::path& step : steps)
        if (!fs::exists(step / (it->first + ".exr")))
          refuse((step / (it->first + ".exr")).string() + " is missing; other steps have it");
    it = it->second.size() == steps.size() ? std::next(it) : set.maps.erase(it);
  }
  return set;
}

SampleSet ofSequences(const fs::path& folder) {
  SampleSet set;
  set.maps = sequencesIn(folder);
  const auto diffuse = set.maps.find("Diffuse");
  if (diffuse == set.maps.end())
    refuse(folder.string() +
           " holds no samples over time: neither t0000/Diffuse.exr nor Diffuse.0000.exr");
  for (const auto& [name, files] : set.maps)
    if (files.size() != diffuse->second.size())
      refuse(folder.string() + ": there are " + std::to_string(files.size()) + " files of " + name +
             " and " + std::to_string(diffuse->second.size()) + " of Diffuse");
  return set;
}

void settleTimes(SampleSet& set) {
  const std::size_t steps = set.maps.at("Diffuse").size();
  set.times_told = !set.times.empty();
  if (!set.times_told)
    for (std::size_t i = 0; i < steps; ++i)
      set.times.push_back(steps > 1 ? static_cast<double>(i) / static_cast<double>(steps - 1) : 0);
  if (set.times.size() != steps)
    refuse("manifest.json tells " + std::to_string(set.times.size()) + " times; there are " +
           std::to_string(steps) + " steps");
  const auto [first, last] = std::minmax_element(set.times.begin(), set.times.end());
  if (*first >= 0 && *last <= 1) return;
  const double from = *first, span = *last - *first;
  if (!(span > 0)) refuse("all steps are at the same time");
  for (double& t : set.times) t = std::clamp((t - from) / span, 0.0, 1.0);
}

}  // namespace

SampleSet openSamples(const std::vector<fs::path>& inputs) {
  PATINA_CHECK(!inputs.empty());
  SampleSet set;
  const std::vector<fs::path> steps = inputs.size() == 1 ? stepFolders(inputs[0]) : inputs;
  set = steps.empty() ? ofSequences(inputs[0]) : ofSteps(steps);
  if (inputs.size() == 1)
    if (const auto manifest = manifestIn(inputs[0])) {
      takeFacts(*manifest, set);
      if (const auto times = manifest->numbers("times")) set.times = *times;
    }
  settleTimes(set);
  return set;
}

TimeSamples readSamples(const SampleSet& set, const std::string& name, Progress& progress) {
  const auto found = set.maps.find(name);
  if (found == set.maps.end())
    throw ProcessingError(Exit::kUsage, "there is no map '" + name + "' in every step");
  TimeSamples samples;
  samples.name = name;
  samples.times = set.times;
  samples.maps.resize(found->second.size());
  progress.begin("reading " + name, static_cast<std::int64_t>(samples.maps.size()));
  tbb::parallel_for(std::size_t{0}, samples.maps.size(), [&](std::size_t i) {
    const fs::path& file = found->second[i];
    try {
      samples.maps[i] = readPicture(file).linear;
    } catch (const ProcessingError& e) {
      throw ProcessingError(e.exit(), file.string() + ": " + e.what());
    }
    progress.step();
  });
  chooseRange(samples);
  checkSamples(samples);
  return samples;
}

}  // namespace patina::stbrdf
