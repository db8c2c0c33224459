// SPDX-License-Identifier: GPL-3.0-or-later
// patina run after RUN: the products of a finished run that are not made yet. The daemon calls it
// in a process of its own.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>

#include "capture/app/context.h"
#include "capture/app/daemon/run_files.h"
#include "capture/app/verbs/run_session.h"
#include "capture/app/verbs/run_verbs.h"

namespace patina::app {
namespace {

// Behind everything else: threads that are made from here on inherit it.
void yieldToAll() {
  constexpr int kLowest = 19, kIoWhoProcess = 1, kIoIdle = 3 << 13;
  setpriority(PRIO_PROCESS, 0, kLowest);
  syscall(SYS_ioprio_set, kIoWhoProcess, 0, kIoIdle);
}

struct Choices {
  std::string run;
  bool with_parent = false, so_far = false;
};

void after(Context& context, const Choices& choices) {
  if (choices.with_parent) {
    const pid_t parent = getppid();
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) throw Stopped();  // it has died meanwhile
    yieldToAll();
  }
  const db::ArchiveReader reader(context.archive());
  const db::RunRow run = reader.findRun(choices.run);
  if (run.state != "finished" && !choices.so_far)
    throw AppError(Exit::kUsage, "run " + run.id + " is " + run.state + ", not finished");
  std::filesystem::path plan = "plan.toml";
  for (const db::EventRow& event : reader.events(run.id))
    if (event.kind == "plan") plan = event.detail;
  RunFiles files;
  files.plan = capture::parsePlan(run.plan_toml, plan);
  files.plan.seed = run.seed;
  files.rig = devices::parseRig(run.rig_toml, files.plan.rig_file);
  if (choices.so_far)
    return workflow::feedRun(context.archive(), run.id, afterOptions(files), context.progress);
  finishAfter(context, files, run.id, std::move(Item().set("run_id", run.id.c_str())));
}

}  // namespace

void addRunAfterVerb(Verb& group) {
  auto chosen = std::make_shared<Choices>();
  group
      .verb("after", "Makes the products of a finished run's [after] steps that are not there yet",
            "patina run after latest --archive banana",
            [chosen](Context& context) { after(context, *chosen); })
      .required("RUN", chosen->run, "A run: an id, a unique prefix of one, or latest")
      .flag("--so-far", chosen->so_far,
            "Of a run that goes on: the BRDF sets of steps that wait for no other")
      .flag("--with-parent", chosen->with_parent,
            "At the lowest priority, and no longer than who "
            "called")
      .conceal("--with-parent");
}

}  // namespace patina::app
