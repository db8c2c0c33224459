// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lights_file.h"

#include <cmath>
#include <set>
#include <sstream>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

[[noreturn]] void reject(const std::string& source, int line, const std::string& problem) {
  throw WorkflowError(Exit::kBadData, source + ":" + std::to_string(line) + ": " + problem);
}

}  // namespace

std::vector<LightDirection> parseLights(const std::string& text, const std::string& source) {
  std::istringstream lines(text);
  std::string line;
  long expected = -1;
  std::vector<LightDirection> lights;
  std::set<std::string> seen;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string first;
    if (!(words >> first)) continue;
    if (expected < 0) {
      char* end = nullptr;
      expected = std::strtol(first.c_str(), &end, 10);
      if (*end != '\0' || expected < 1) reject(source, number, "the number of lights comes first");
      continue;
    }
    LightDirection light{first, {}};
    for (double& component : light.direction)
      if (!(words >> component) || !std::isfinite(component))
        reject(source, number, "a light is `name x y z`");
    const auto& [x, y, z] = light.direction;
    if (!(x * x + y * y + z * z > 0)) reject(source, number, first + " has no direction");
    if (!seen.insert(first).second) reject(source, number, first + " comes twice");
    lights.push_back(light);
  }
  if (expected != static_cast<long>(lights.size()))
    reject(source, 1,
           "says " + std::to_string(std::max(expected, 0L)) + " lights but lists " +
               std::to_string(lights.size()));
  return lights;
}

std::vector<LightDirection> readLights(const std::filesystem::path& file) {
  const Bytes bytes = readFile(file, 16 << 20);
  return parseLights(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
                     file.string());
}

std::string textOfLights(const std::vector<LightDirection>& lights) {
  std::string text = std::to_string(lights.size()) + "\n";
  for (const LightDirection& light : lights) {
    if (light.file.empty() || light.file.find_first_of(" \t\r\n") != std::string::npos)
      throw WorkflowError(Exit::kUsage, "'" + light.file +
                                            "' cannot be named in a light file: rename the picture "
                                            "without blanks");
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, " %.6f %.6f %.6f\n", light.direction[0],
                  light.direction[1], light.direction[2]);
    text += light.file;
    text += numbers;
  }
  return text;
}

void writeLights(const std::filesystem::path& file, const std::vector<LightDirection>& lights) {
  writeFileAtomically(file, textOfLights(lights));
}

}  // namespace patina::workflow
