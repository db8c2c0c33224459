// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/places.h"

#include <cstdlib>
#include <stdexcept>

namespace fs = std::filesystem;

namespace patina::testing {

fs::path programFolder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

fs::path sourceFolder() {
  for (fs::path folder = programFolder(); folder != folder.root_path();
       folder = folder.parent_path())
    if (fs::exists(folder / "CMakePresets.json")) return folder;
  throw std::runtime_error("the test program does not lie in a build folder of the source tree");
}

fs::path program() {
  if (const char* named = std::getenv("PATINA_PROGRAM")) return named;
  return programFolder().parent_path() / "patina";
}

std::optional<fs::path> testData(const std::string& name) {
  const char* folder = std::getenv("PATINA_TEST_DATA");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  return fs::absolute(folder) / name;
}

}  // namespace patina::testing
