// SPDX-License-Identifier: GPL-3.0-or-later
// How an operation that cannot go on is told to the person who asked for it.
#pragma once

#include <stdexcept>
#include <string>

namespace patina {

// Exit codes of `patina`, after sysexits(3). The value says what the CALLER should do.
enum class Exit {
  kOk = 0,
  kUsage = 64,         // the command line is wrong
  kBadData = 65,       // an input file is malformed, truncated or not what it claims to be
  kUnavailable = 69,   // a device or a package is not there
  kBug = 70,           // ours; please report
  kCannotCreate = 73,  // an output cannot be made
  kIo = 74,            // the disk failed
  kTemporary = 75,     // locked or busy: try again
  kPermission = 77,
  kConfig = 78  // a plan, rig or faults file is wrong
};

// Base of the one exception of each layer. `what()` is one line: what happened, to which file or
// device, and what to do about it. main() turns it into that line and the exit code.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& what) : std::runtime_error(what), exit_(exit) {}
  Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

// The one exception of processing/ (and of its *_file.h readers and writers).
class ProcessingError : public Failure {
 public:
  using Failure::Failure;
};

// Our own bug: prints the condition, file and line and aborts. Never for input.
[[noreturn]] void failCheck(const char* condition, const char* file, int line);
#define PATINA_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::patina::failCheck(#condition, __FILE__, __LINE__))

}  // namespace patina
