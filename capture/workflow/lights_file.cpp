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

}  // namespace patina::workflow
