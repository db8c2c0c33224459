// SPDX-License-Identifier: GPL-3.0-or-later
// The gphoto2 command line as a user would run it, with a home of its own: it keeps its last port
// there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/child.h"

namespace patina::testing {

class Gphoto2Cli {
 public:
  static constexpr const char* kProgram = "/usr/bin/gphoto2";
  static bool isThere() { return std::filesystem::exists(kProgram); }

  explicit Gphoto2Cli(std::string port) : port_(std::move(port)) {}
  Finished operator()(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {kProgram, "--port", port_});
    return run(arguments, {"HOME=" + folder.path().string(), "LC_ALL=C", "TZ=UTC"});
  }

  TempFolder folder = TempFolder::inMemory();

 private:
  std::string port_;
};

}  // namespace patina::testing
