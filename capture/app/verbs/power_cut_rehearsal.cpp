// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/power_cut_rehearsal.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "db/power_cut.h"
#include "processing/image/random.h"

extern char** environ;

namespace patina::app {
namespace {

namespace fs = std::filesystem;

// The same program with the same arguments and some more; the children take the signals' default
// state from their own main().
pid_t start(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  std::string name = "patina";
  argv.push_back(name.data());
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int failed = posix_spawn(&pid, "/proc/self/exe", nullptr, nullptr, argv.data(), environ);
  if (failed != 0)
    throw AppError(Exit::kTemporary, std::string("cannot start a process: ") + strerror(failed));
  return pid;
}

int waitFor(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::vector<devices::Fault> powerCuts(const devices::FaultPlan& faults) {
  std::vector<devices::Fault> cuts;
  for (const devices::Fault& fault : faults.faults)
    if (fault.kind == devices::FaultKind::kPowerCut) cuts.push_back(fault);
  std::sort(cuts.begin(), cuts.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  return cuts;
}

std::function<void(db::CommitPoint)> dieAt(std::uint64_t seed, std::size_t cut_number,
                                           std::function<bool()> is_time) {
  constexpr db::CommitPoint kInTheMiddle[] = {
      db::CommitPoint::kTmpWritten, db::CommitPoint::kTmpSynced, db::CommitPoint::kRenamed,
      db::CommitPoint::kFolderSynced, db::CommitPoint::kJournalSynced};
  const db::CommitPoint chosen =
      kInTheMiddle[uniformBelow(hashSeed(seed, cut_number), std::size(kInTheMiddle))];
  return [chosen, is_time = std::move(is_time)](db::CommitPoint point) {
    if (point == chosen && is_time()) kill(getpid(), SIGKILL);
  };
}

void superviseRehearsal(Context& context, const std::vector<devices::Fault>& cuts,
                        std::uint64_t seed) {
  fs::path log = fs::absolute(context.archive()).lexically_normal();
  if (!log.has_filename()) log = log.parent_path();
  log += ".power-cut";
  for (std::size_t done = 0;; ++done) {
    std::vector<std::string> arguments = context.arguments;
    arguments.insert(arguments.end(),
                     {"--cuts-done", std::to_string(done), "--power-cut-log", log.string()});
    if (done > 0)
      arguments.insert(arguments.end(), {"--off", formatDuration(cuts[done - 1].duration)});
    const pid_t child = start(arguments);
    context.signals.onStop([child] { kill(child, SIGTERM); });
    const int status = waitFor(child);
    context.signals.onStop({});
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL && done < cuts.size()) {
      const db::CutReport cut = db::cutPower(log, hashSeed(seed, done));
      if (!context.options.quiet && !context.options.json)
        std::fprintf(stderr,
                     "The power failed %s into the run, in the middle of a commit: %d of %d writes "
                     "not yet synced are gone. It is back after %s.\n",
                     formatDuration(cuts[done].at).c_str(), cut.writes_lost, cut.writes,
                     formatDuration(cuts[done].duration).c_str());
      continue;
    }
    std::error_code none;
    fs::remove_all(log, none);
    if (WIFSIGNALED(status))
      throw AppError(Exit::kBug,
                     "the rehearsal died of signal " + std::to_string(WTERMSIG(status)));
    context.exit_code = WEXITSTATUS(status);
    context.answered = true;
    return;
  }
}

}  // namespace patina::app
