// SPDX-License-Identifier: GPL-3.0-or-later
// Runs `patina` (or any program) as its user would, in a process of its own.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "tests/support/temp_folder.h"

namespace patina::testing {

struct Finished {
  int exit = -1;   // -1 when a signal ended it
  int signal = 0;  // 0 when it ended by itself
  std::string out, err;
};

// A process that is running. Ended by SIGKILL when the object goes before it was waited for.
class Child {
 public:
  // `command[0]` is a path; `environment` ("NAME=value") is added to ours. Standard input is empty.
  explicit Child(std::vector<std::string> command,
                 const std::vector<std::string>& environment = {});
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  Finished wait();

 private:
  TempFolder folder_ = TempFolder::inMemory();
  pid_t pid_ = 0;
};

// runPatina({"archive", "verify", "--archive", folder}): the built program, to its end.
Finished runPatina(std::vector<std::string> arguments,
                   const std::vector<std::string>& environment = {});
Finished run(std::vector<std::string> command, const std::vector<std::string>& environment = {});

}  // namespace patina::testing
