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

}  // namespace patina::workflow
