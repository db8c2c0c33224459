// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "processing/image/atomic_file.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/polynomial_fit.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "patina.staf-set/1";
struct Names {
  const char *map, *factor, *curves;
  std::array<const char*, 3> labels;
};
constexpr std::array<Names, 3> kNames{
    {{"Diffuse", "Kd", "Kd", {"pphi_r:", "pphi_g:", "pphi_b:"}},
     {"Specular", "Ks", "Ks", {"pphi_Ks:", nullptr, nullptr}},
     {"Roughness", "Sigma", "Ks", {"pphi_S:", nullptr, nullptr}}}};

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kBadData, what); }

// The one file whose name ends so; the database puts the sample's name before it.
fs::path fileEnding(const fs::path& folder, const std::string& end) {
  fs::path found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!entry.path().filename().string().ends_with(end)) continue;
    if (!found.empty()) refuse(folder.string() + " holds more than one file *" + end);
    found = entry.path();
  }
  if (error) refuse(folder.string() + " cannot be read: " + error.message());
  if (found.empty()) refuse(folder.string() + " has no file *" + end);
  return found;
}

// Numbers that follow `label`, highest power first, any count before them left out.
std::array<double, kStafDegree + 1> readCurve(const fs::path& file, const std::string& label) {
  const Bytes bytes = readFile(file, 1 << 20);
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find(label);
    if (at == std::string::npos) continue;
    std::istringstream words(line.substr(at + label.size()));
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
      char* end = nullptr;
      const double v = std::strtod(word.c_str(), &end);
      if (*end != '\0' || !std::isfinite(v))
        refuse(file.string()
                   .append(": '")
                   .append(word)
                   .append("' after ")
                   .append(label)
                   .append(" is no number"));
      numbers.push_back(v);
    }
    constexpr std::size_t kTerms = kStafDegree + 1;
    if (numbers.size() == kTerms + 1 && numbers[0] == kTerms) numbers.erase(numbers.begin());
    if (numbers.empty() || numbers.size() > kTerms)
      refuse(file.string() + ": " + label + " has " + std::to_string(numbers.size()) +
             " coefficients, not 1 to " + std::to_string(kTerms));
    std::array<double, kTerms> curve{};
    std::copy(numbers.rbegin(), numbers.rend(), curve.begin());
    return curve;
  }
  refuse(file.string() + " has no line " + label);
}

Image<float> channelOf(const Image<float>& map, int channel) {
  Image<float> out(map.width(), map.height(), 1);
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      out.at(x, y) = map.at(x, y, std::min(channel, map.channels() - 1));
  return out;
}

StafMap readMap(const fs::path& folder, const Names& names) {
  std::array<Image<float>, 4> factors;
  std::array<fs::path, 4> files;
  for (std::size_t f = 0; f < 4; ++f) {
    files[f] = fileEnding(folder, std::string("staf-") + names.factor + "-" + "ABCD"[f] + ".exr");
    factors[f] = readPicture(files[f]).linear;
    if (factors[f].size() != factors[0].size())
      refuse(files[f].string() + " differs in size from " + files[0].string());
    for (const float v : factors[f].texels())
      if (!std::isfinite(v)) refuse(files[f].string() + " holds a value that is no number");
  }
  for (const float b : factors[1].texels())
    if (b == 0) refuse(files[1].string() + " holds a 0; it divides the time");
  const fs::path curves = fileEnding(folder, std::string("staf-") + names.curves + "-phi.txt");
  StafMap map{.name = names.map, .channels = {}};
  for (std::size_t c = 0; c < names.labels.size() && names.labels[c]; ++c) {
    const int channel = static_cast<int>(c);
    StafChannel out;
    out.a = channelOf(factors[0], channel);
    out.rate = channelOf(factors[1], channel);
    out.offset = channelOf(factors[2], channel);
    out.d = channelOf(factors[3], channel);
    for (std::size_t i = 0; i < out.rate.texels().size(); ++i) {
      out.rate.texels()[i] = 1 / out.rate.texels()[i];
      out.offset.texels()[i] *= out.rate.texels()[i];
    }
    out.curve = readCurve(curves, names.labels[c]);
    map.channels.push_back(std::move(out));
  }
  return map;
}

// A, B, C, D of all channels as the database has them.
std::array<Image<float>, 4> factorsOf(const StafMap& map) {
  const Image<float>& first = map.channels[0].a;
  const int channels = static_cast<int>(map.channels.size());
  std::array<Image<float>, 4> out;
  out.fill(Image<float>(first.width(), first.height(), channels));
  for (int c = 0; c < channels; ++c) {
    const StafChannel& in = map.channels[static_cast<std::size_t>(c)];
    for (int y = 0; y < first.height(); ++y)
      for (int x = 0; x < first.width(); ++x) {
        out[0].at(x, y, c) = in.a.at(x, y);
        out[1].at(x, y, c) = 1 / in.rate.at(x, y);
        out[2].at(x, y, c) = in.offset.at(x, y) / in.rate.at(x, y);
        out[3].at(x, y, c) = in.d.at(x, y);
      }
  }
  return out;
}

std::string curveLine(const char* label, const StafChannel& channel) {
  std::ostringstream line;
  line.precision(17);
  line << ' ' << label;
  for (auto a = channel.curve.rbegin(); a != channel.curve.rend(); ++a) line << ' ' << *a;
  line << " \n";
  return line.str();
}

void writeInto(const fs::path& folder, const StafSet& set) {
  std::string kd, ks;
  for (const StafMap& map : set.maps) {
    const auto names = std::find_if(kNames.begin(), kNames.end(),
                                    [&](const Names& n) { return map.name == n.map; });
    if (names == kNames.end())
      throw ProcessingError(Exit::kUsage, "a STAF folder has no place for " + map.name);
    const std::array<Image<float>, 4> factors = factorsOf(map);
    for (std::size_t f = 0; f < 4; ++f)
      writeExr(folder / (std::string("staf-") + names->factor + "-" + "ABCD"[f] + ".exr"),
               factors[f].view());
    for (std::size_t c = 0; c < map.channels.size() && c < 3 && names->labels[c]; ++c)
      (names == kNames.begin() ? kd : ks) += curveLine(names->labels[c], map.channels[c]);
  }
  writeFileAtomically(folder / "staf-Kd-phi.txt", kd);
  writeFileAtomically(folder / "staf-Ks-phi.txt", ks);
  brdf::Manifest manifest;
  manifest.text("format", kFormat).text("model", set.model).text("roughness", set.roughness);
  writeFileAtomically(folder / "manifest.json", manifest.json());
}

// The database's Sigma is 1 / sigma^2, its Ks what is left when the lobe is not normalised (eq. 9).
void decouple(Image<float>& ks, Image<float>& sigma) {
  for (std::size_t i = 0; i < sigma.texels().size(); ++i) {
    const float inverse = sigma.texels()[i];
    if (!(inverse > 0)) {
      sigma.texels()[i] = 1;
      ks.texels()[i] = 0;
      continue;
    }
    const double s2 = 1.0 / inverse;
    ks.texels()[i] = static_cast<float>(
        std::clamp(ks.texels()[i] * s2 * M_PI * (1 - std::exp(-1 / s2)), 0.0, 1.0));
    sigma.texels()[i] = static_cast<float>(std::min(1.0, std::sqrt(s2)));
  }
}

}  // namespace

StafSet readStafSet(const fs::path& folder) {
  StafSet set;
  std::error_code error;
  set.as_measured = !fs::is_regular_file(folder / "manifest.json", error);
  if (!set.as_measured) {
    const brdf::Manifest manifest = brdf::readManifest(folder);
    if (manifest.text("format") != kFormat)
      refuse((folder / "manifest.json").string() + ": `format` is not " + std::string(kFormat));
    set.model = manifest.text("model").value_or(set.model);
    set.roughness = manifest.text("roughness").value_or(set.roughness);
  }
  for (const Names& names : kNames) {
    set.maps.push_back(readMap(folder, names));
    if (set.maps.back().channels[0].a.size() != set.maps[0].channels[0].a.size())
      refuse(folder.string() + ": " + names.factor + " differs in size from Kd");
  }
  return set;
}

void writeStafSet(const fs::path& folder, const StafSet& set) {
  if (fs::exists(folder))
    throw ProcessingError(Exit::kCannotCreate, folder.string() + " is there already");
  writeFolderAtomically(folder, [&](const fs::path& temporary) { writeInto(temporary, set); });
}

StbrdfSet stafPolynomials(const StafSet& set, int degree, Progress& progress) {
  StbrdfSet out;
  out.model = set.model;
  out.roughness = set.roughness;
  if (!set.as_measured) {
    out.degree = kStafDegree;
    for (const StafMap& map : set.maps) out.maps.push_back(polynomialsOf(map));
    return out;
  }
  constexpr int kTimes = 50;
  out.degree = degree;
  out.basis = basisOf(degree);
  std::vector<TimeSamples> samples(set.maps.size());
  for (int t = 0; t < kTimes; ++t) {
    const double time = t / (kTimes - 1.0);
    std::vector<Image<float>> maps;
    for (const StafMap& map : set.maps) maps.push_back(evaluate(map, time, Clamp::kNone));
    decouple(maps[1], maps[2]);
    for (std::size_t m = 0; m < maps.size(); ++m) {
      samples[m].name = set.maps[m].name;
      samples[m].times.push_back(time);
      samples[m].maps.push_back(std::move(maps[m]));
    }
  }
  for (const TimeSamples& map : samples)
    out.maps.push_back(fitMap(map, {.degree = degree, .weights = {}}, progress).map);
  return out;
}

}  // namespace patina::stbrdf
