// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "processing/image/failure.h"

namespace patina::app {
namespace {

class UsageError : public Failure {
 public:
  explicit UsageError(const std::string& what) : Failure(Exit::kUsage, what) {}
};

constexpr const char* kEverywhere = "Everywhere";

}  // namespace

struct CommandTree {
  CLI::App app{"Patina watches a surface grow old and gives the ageing back as a texture."};
  GlobalOptions options;
  std::vector<std::string> running;  // names of the verb that was chosen
  Verb::Action action;
};

struct Verb::Node {
  CLI::App* app = nullptr;
  CommandTree* state = nullptr;
  std::vector<std::string> names;
};

Verb::Verb(std::shared_ptr<Node> node) : node_(std::move(node)) {}

namespace {

void addGlobals(CLI::App& app, GlobalOptions& options) {
  app.add_flag("--json", options.json, "One JSON object on stdout instead of a table")
      ->group(kEverywhere);
  app.add_flag("--quiet", options.quiet, "Only results and errors")->group(kEverywhere);
  app.add_flag("--verbose", options.verbose, "Say more on stderr")->group(kEverywhere);
  app.add_option("--threads", options.threads, "Threads to use (default: all processors)")
      ->check(CLI::Range(1, 4096))
      ->type_name("N")
      ->group(kEverywhere);
  app.add_option_function<std::uint64_t>(
         "--seed", [&options](const std::uint64_t& seed) { options.seed = seed; },
         "Seed of everything random")
      ->type_name("N")
      ->group(kEverywhere);
  app.add_option_function<std::string>(
         "--archive", [&options](const std::string& folder) { options.archive = folder; },
         "The archive's folder (default: $PATINA_ARCHIVE)")
      ->type_name("DIR")
      ->group(kEverywhere);
}

// A value's own parser throws our exception; CLI11 wants its own, which names the option.
std::function<void(const std::string&)> named(const std::string& name, Verb::Take take) {
  return [name, take = std::move(take)](const std::string& text) {
    try {
      take(text);
    } catch (const Failure& failure) {
      throw CLI::ValidationError(name, failure.what());
    }
  };
}

}  // namespace

Verb Verb::group(const std::string& name, const std::string& help) {
  auto node = std::make_shared<Node>(*node_);
  node->app = node_->app->add_subcommand(name, help);
  node->app->require_subcommand(1);
  node->names.push_back(name);
  return Verb(std::move(node));
}

Verb& Verb::byDefault(Action action) {
  CLI::App* app = node_->app;
  addGlobals(*app, node_->state->options);
  app->require_subcommand(0, 1);
  app->final_callback(
      [app, state = node_->state, names = node_->names, action = std::move(action)] {
        if (!app->get_subcommands().empty()) return;
        state->running = names;
        state->action = action;
      });
  return *this;
}

Verb Verb::verb(const std::string& name, const std::string& help, const std::string& example,
                Action action) {
  auto node = std::make_shared<Node>(*node_);
  node->app = node_->app->add_subcommand(name, help);
  node->app->footer("Example:\n  " + example);
  node->names.push_back(name);
  addGlobals(*node->app, node->state->options);
  node->app->final_callback([state = node->state, names = node->names, action = std::move(action)] {
    state->running = names;
    state->action = action;
  });
  return Verb(std::move(node));
}

Verb& Verb::required(const std::string& name, std::string& into, const std::string& help) {
  node_->app->add_option(name, into, help)->required()->type_name("");
  return *this;
}

Verb& Verb::optional(const std::string& name, std::string& into, const std::string& help) {
  node_->app->add_option(name, into, help)->type_name("");
  return *this;
}

Verb& Verb::list(const std::string& name, std::vector<std::string>& into, const std::string& help) {
  node_->app->add_option(name, into, help)->type_name("");
  return *this;
}

Verb& Verb::take(const std::string& name, const std::string& value, Take take,
                 const std::string& help) {
  node_->app->add_option_function<std::string>(name, named(name, std::move(take)), help)
      ->type_name(value);
  return *this;
}

Verb& Verb::flag(const std::string& name, bool& into, const std::string& help) {
  node_->app->add_flag(name, into, help);
  return *this;
}

Verb& Verb::option(const std::string& name, std::string& into, const std::string& value,
                   const std::string& help) {
  node_->app->add_option(name, into, help)->type_name(value);
  return *this;
}

Verb& Verb::option(const std::string& name, std::vector<std::string>& into,
                   const std::string& value, const std::string& help) {
  node_->app->add_option(name, into, help)
      ->type_name(value)
      ->delimiter(',')
      ->allow_extra_args(false);
  return *this;
}

Verb& Verb::option(const std::string& name, int& into, int least, int most,
                   const std::string& help) {
  node_->app->add_option(name, into, help)->check(CLI::Range(least, most))->type_name("N");
  return *this;
}

Verb& Verb::option(const std::string& name, double& into, double least, double most,
                   const std::string& help) {
  node_->app->add_option(name, into, help)->check(CLI::Range(least, most))->type_name("X");
  return *this;
}

Verb& Verb::demand(const std::string& name) {
  node_->app->get_option(name)->required();
  return *this;
}

Verb& Verb::conceal(const std::string& name) {
  node_->app->get_option(name)->group("");
  return *this;
}

CommandLine::CommandLine() : state_(std::make_unique<CommandTree>()) {
  CLI::App& app = state_->app;
  app.name("patina");
  app.require_subcommand(1);
  app.set_version_flag("--version", "patina " PATINA_VERSION);
  app.footer("Example:\n  patina import pictures/ --specimen ivy --times names --archive ivy");
  addGlobals(app, state_->options);
  if (const char* archive = std::getenv("PATINA_ARCHIVE")) state_->options.archive = archive;
}

CommandLine::~CommandLine() = default;

GlobalOptions& CommandLine::options() { return state_->options; }

Verb CommandLine::root() {
  auto node = std::make_shared<Verb::Node>();
  node->app = &state_->app;
  node->state = state_.get();
  return Verb(std::move(node));
}

std::optional<std::string> CommandLine::parse(int argc, char** argv) {
  // An error in the options must still know in which form to appear.
  for (int i = 1; i < argc; ++i)
    if (argv[i] == std::string("--json")) state_->options.json = true;
  try {
    state_->app.parse(argc, argv);
  } catch (const CLI::CallForVersion& call) {
    return std::string(call.what()) + "\n";
  } catch (const CLI::CallForHelp&) {
    return state_->app.help();
  } catch (const CLI::ParseError& error) {
    const CLI::App* at = &state_->app;
    std::string verb = "patina";
    for (auto inner = at->get_subcommands(); !inner.empty(); inner = at->get_subcommands()) {
      at = inner.front();
      verb += " " + at->get_name();
    }
    throw UsageError(std::string(error.what()) + " (see `" + verb + " --help`)");
  }
  return std::nullopt;
}

std::string CommandLine::verbName() const {
  std::string name;
  for (const std::string& part : state_->running) name += (name.empty() ? "" : " ") + part;
  return name;
}

void CommandLine::run(Context& context) { state_->action(context); }

RectPx parseRect(const std::string& text) {
  RectPx rect;
  int used = 0;
  const int fields = std::sscanf(text.c_str(), "%d,%d,%d,%d%n", &rect.x, &rect.y, &rect.width,
                                 &rect.height, &used);
  if (fields != 4 || used != static_cast<int>(text.size()) || rect.x < 0 || rect.y < 0 ||
      rect.width < 1 || rect.height < 1)
    throw UsageError("'" + text + "' is no region: X,Y,WIDTH,HEIGHT in pixels, as 0,0,512,448");
  return rect;
}

std::vector<RectPx> parseRects(const std::string& option, const std::vector<std::string>& numbers) {
  if (numbers.size() % 4 != 0) throw UsageError("a " + option + " is X,Y,W,H in pixels");
  std::vector<RectPx> rects;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    std::string text = numbers[i];
    for (std::size_t k = 1; k < 4; ++k) text.append(",").append(numbers[i + k]);
    rects.push_back(parseRect(text));
  }
  return rects;
}

}  // namespace patina::app
