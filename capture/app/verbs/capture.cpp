// SPDX-License-Identifier: GPL-3.0-or-later
// patina capture PLAN: the plan now, in real time.
#include "capture/app/verbs/run_session.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

void runCapture(Context& context, const RunOptions& options) {
  const RunFiles files = readRunFiles(context, options.plan);
  OwnedArchive archive(context, options);
  const capture::RunStart start =
      capture::startRun(files.plan, files.rig, *archive, context.clock, {options.new_run, {}});
  runToEnd(context, options, files, archive, context.clock, start);
}

}  // namespace

void addCaptureVerb(Verb root) {
  auto options = std::make_shared<RunOptions>();
  Verb verb = root.verb("capture",
                        "The plan now, in the foreground. SIGUSR1 shoots at once, SIGTERM finishes "
                        "the frame and stops; started again it goes on at the next step",
                        "patina capture examples/banana/plan.toml --archive banana",
                        [options](Context& context) { runCapture(context, *options); });
  addRunOptions(verb, options);
}

}  // namespace patina::app
