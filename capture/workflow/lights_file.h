// SPDX-License-Identifier: GPL-3.0-or-later
// Light directions, .lp: a count, then a line "name x y z" for each picture; x right, y up, z to
// the camera.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace patina::workflow {

struct LightDirection {
  std::string file;                   // the picture's name
  std::array<double, 3> direction{};  // as written; usually of length 1
};
// Throws WorkflowError(kBadData) with file, line and what is wrong.
std::vector<LightDirection> readLights(const std::filesystem::path& file);
std::vector<LightDirection> parseLights(const std::string& text, const std::string& source);
// Six decimals: a ten-thousandth of a degree. Throws WorkflowError(kUsage) for a name with a blank,
// which other programs could not read.
std::string textOfLights(const std::vector<LightDirection>& lights);
// The file appears whole or not at all.
void writeLights(const std::filesystem::path& file, const std::vector<LightDirection>& lights);

}  // namespace patina::workflow
