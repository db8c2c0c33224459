// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as verbs and options. Hides CLI11, which costs seconds of compilation a file.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/image/units.h"

namespace patina::app {

struct Context;
struct CommandTree;

// What every verb understands.
struct GlobalOptions {
  bool json = false, quiet = false, verbose = false;
  int threads = 0;                    // 0: all
  std::optional<std::uint64_t> seed;  // nothing: the plan's, or 1
  std::filesystem::path archive;      // --archive, else $PATINA_ARCHIVE, else empty
};

// A place in the tree of verbs; a cheap handle. References given to it must live until the action
// has run: verbs keep their options in a shared_ptr that the action holds.
class Verb {
 public:
  using Action = std::function<void(Context&)>;
  using Take = std::function<void(const std::string&)>;  // may throw ProcessingError(kUsage)

  Verb group(const std::string& name, const std::string& help);  // holds verbs, does nothing itself
  Verb& byDefault(Action action);                                // of a group that is named alone
  Verb verb(const std::string& name, const std::string& help, const std::string& example,
            Action action);

  // Positional arguments, in order.
  Verb& required(const std::string& name, std::string& into, const std::string& help);
  Verb& optional(const std::string& name, std::string& into, const std::string& help);
  Verb& list(const std::string& name, std::vector<std::string>& into, const std::string& help);

  // `name` as typed: "--out"; `value` names its value in the help: "FILE".
  Verb& take(const std::string& name, const std::string& value, Take take, const std::string& help);
  Verb& flag(const std::string& name, bool& into, const std::string& help);
  Verb& option(const std::string& name, std::string& into, const std::string& value,
               const std::string& help);
  Verb& option(const std::string& name, std::vector<std::string>& into, const std::string& value,
               const std::string& help);
  Verb& option(const std::string& name, int& into, int least, int most, const std::string& help);
  Verb& option(const std::string& name, double& into, double least, double most,
               const std::string& help);
  // Values with a form of their own: parse is parseSize, parseDuration, ...
  template <class T, class Parse>
  Verb& option(const std::string& name, T& into, Parse parse, const std::string& value,
               const std::string& help) {
    return take(
        name, value, [&into, parse](const std::string& text) { into = parse(text); }, help);
  }
  Verb& demand(const std::string& name);   // the option must be given
  Verb& conceal(const std::string& name);  // not in the help: for tests and supervisors

 private:
  friend class CommandLine;
  struct Node;
  explicit Verb(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

class CommandLine {
 public:
  CommandLine();
  ~CommandLine();
  Verb root();
  GlobalOptions& options();

  // Finds the verb and fills the options. Text to print instead of running (help, version), or
  // nothing. Throws Failure(kUsage).
  std::optional<std::string> parse(int argc, char** argv);
  std::string verbName() const;  // "ttf build"
  void run(Context& context);    // the action of the verb

 private:
  std::unique_ptr<CommandTree> state_;
};

RectPx parseRect(const std::string& text);  // "X,Y,WIDTH,HEIGHT"; Failure(kUsage)
// Of an option that may be given again: such lists arrive without their commas.
std::vector<RectPx> parseRects(const std::string& option, const std::vector<std::string>& numbers);

}  // namespace patina::app
