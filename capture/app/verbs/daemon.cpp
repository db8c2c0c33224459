// SPDX-License-Identifier: GPL-3.0-or-later
// patina daemon: the runs of one archive, in the background, until it is told to stop.
#include "capture/app/daemon/daemon.h"

#include <cstdio>
#include <mutex>

#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

struct DaemonChoices {
  std::string config, plans, start, log_acks;
  int port = -1;
  bool rehearse = false;
  double speed = 0;
};

daemon::DaemonOptions optionsOf(const Context& context, const DaemonChoices& chosen) {
  if (chosen.speed > 0 && !chosen.rehearse)
    throw AppError(Exit::kUsage, "--speed is for --rehearse: real devices run in real time");
  daemon::DaemonOptions options;
  options.archive = context.archive();
  options.command = context.command;
  options.version = PATINA_VERSION;
  options.config = chosen.config;
  if (!chosen.plans.empty()) options.plans = std::filesystem::absolute(chosen.plans);
  if (chosen.port >= 0) options.port = chosen.port;
  if (chosen.rehearse) options.speed = chosen.speed > 0 ? chosen.speed : 1;
  if (!chosen.start.empty()) options.start = std::filesystem::absolute(chosen.start);
  options.log_acks = chosen.log_acks;
  options.after_command = {std::filesystem::read_symlink("/proc/self/exe").string(),
                           "run",
                           "after",
                           "--archive",
                           std::filesystem::absolute(context.archive()).string(),
                           "--quiet",
                           "--with-parent"};
  return options;
}

void runDaemon(Context& context, const DaemonChoices& chosen) {
  daemon::DaemonOptions options = optionsOf(context, chosen);
  std::mutex lines;
  const bool quiet = context.options.quiet;
  options.say = [&lines, quiet](const std::string& line) {
    if (quiet) return;
    const std::lock_guard lock(lines);
    std::fprintf(stderr, "%s\n", line.c_str());
  };
  daemon::Daemon daemon(options, context.clock);
  std::stop_source stop;
  struct Release {  // the handlers must not outlive what they call
    Signals& signals;
    ~Release() {
      signals.onStop({});
      signals.onReload({});
    }
  } release{context.signals};
  context.signals.onStop([&stop] { stop.request_stop(); });
  context.signals.onReload([&] {
    try {
      daemon.reload();
    } catch (const Failure& failure) {
      options.say(std::string("nothing was reloaded: ") + failure.what());
    }
  });
  daemon.run(stop.get_token());
  context.out.say("Stopped; its runs go on when it is started again.");
}

}  // namespace

void addDaemonVerb(Verb root) {
  auto chosen = std::make_shared<DaemonChoices>();
  Verb verb = root.verb("daemon",
                        "The runs of one archive in the background: unix socket for `patina run`, "
                        "127.0.0.1:8460 for the browser. Unfinished runs go on by themselves. "
                        "SIGTERM finishes the frames and leaves, SIGHUP reads --config again",
                        "patina daemon --archive banana --start examples/banana/plan.toml",
                        [chosen](Context& context) { runDaemon(context, *chosen); });
  verb.option("--config", chosen->config, "FILE", "daemon.toml: plans, port, listen, host_names")
      .option("--plans", chosen->plans, "DIR", "Where plans lie that the network may start")
      .option("--port", chosen->port, 0, 65535, "TCP port (default 8460; 0: any free one)")
      .option("--start", chosen->start, "PLAN", "A plan to start, or go on with, at once")
      .flag("--rehearse", chosen->rehearse, "The twin alone, in a time of its own")
      .option("--speed", chosen->speed, 1, 1000, "Of that time (default 1: real time)")
      .option("--log-acks", chosen->log_acks, "FILE", "A line for each acknowledged frame")
      .conceal("--log-acks");
}

}  // namespace patina::app
