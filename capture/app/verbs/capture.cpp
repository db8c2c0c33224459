// SPDX-License-Identifier: GPL-3.0-or-later
// patina capture PLAN: the plan now, in real time.
#include "capture/app/rig/attached.h"
#include "capture/app/verbs/run_session.h"
#include "capture/app/verbs/verbs.h"
#include "capture/notify/run_notices.h"

namespace patina::app {
namespace {

void runCapture(Context& context, const RunOptions& options) {
  const RunFiles files = readRunFiles(context, options.plan);
  OwnedArchive archive(context, options);
  capture::SessionOptions session{options.new_run, {}};
  if (!options.wait)
    session.before_new = [&] {
      RunFiles planned = files;
      daemon::keepOnlyPlanned(planned);
      rig::requireCameras(planned.rig, context.clock);
    };
  const capture::RunStart start =
      capture::startRun(files.plan, files.rig, *archive, context.clock, session);
  namespace notify = capture::notify;
  notify::Channels channels =
      notify::openChannels(files.plan.alerts, notify::aboutOf(files.plan, files.rig, start.run_id),
                           notify::inventoryOf(files.rig), notify::Mqtt::Purpose::kRun);
  for (const std::string& problem : channels.problems)
    context.warn("nothing will be told through " + problem);
  notify::Dispatcher dispatcher(context.clock);
  if (!channels.open.empty()) dispatcher.start();
  notify::RunNotices notices(dispatcher, context.clock, files.plan, files.rig, start,
                             std::move(channels.open));
  runToEnd(context, options, files, archive, context.clock, start, &notices);
  for (const notify::ChannelReport& report : notices.close())
    if (report.dropped > 0)
      context.warn(report.name + ": " + std::to_string(report.dropped) +
                   " messages were not delivered: " + report.last_error);
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
  verb.flag("--wait", options->wait,
            "Begin a new run although a camera is not there yet, and wait for it step by step");
}

}  // namespace patina::app
