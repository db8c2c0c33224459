// SPDX-License-Identifier: GPL-3.0-or-later
// What a verb works with.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "capture/app/command_line.h"
#include "capture/app/output.h"
#include "capture/app/progress_line.h"
#include "capture/app/signals.h"
#include "devices/clock.h"
#include "processing/image/failure.h"

namespace patina::app {

// A mistake of the verbs' own: options that do not go together, an output that is there already.
class AppError : public Failure {
 public:
  using Failure::Failure;
};

// Throws AppError(kCannotCreate) naming the first of `outputs` that exists; "" is none.
void refuseThatIsThere(std::initializer_list<std::string> outputs);

struct Context {
  const GlobalOptions& options;
  std::string verb;                    // "ttf build"
  std::string command;                 // as typed, quoted for a shell
  std::vector<std::string> arguments;  // as typed, without the program's name
  Output out;
  ProgressLine& progress;
  devices::Clock& clock;  // the real one
  Signals& signals;
  int exit_code = 0;      // of a verb that did its work but has bad news
  bool answered = false;  // a child process has printed the answer

  const std::filesystem::path& archive() const;  // kUsage when none was named
  std::uint64_t seed() const { return options.seed.value_or(1); }
  void warn(const std::string& message) const;     // stderr, not under --quiet
  void verbose(const std::string& message) const;  // stderr, only under --verbose
};

// The command line again, so that a shell would read it the same way.
std::string quoted(int argc, char** argv);

}  // namespace patina::app
