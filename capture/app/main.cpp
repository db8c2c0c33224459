// SPDX-License-Identifier: GPL-3.0-or-later
// `patina`: finds the verb, runs it, and turns whatever happened into one line and an exit code.
#include <malloc.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <optional>
#include <system_error>

#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/camera_worker.h"

namespace patina::app {
namespace {

int fail(Exit exit, const std::string& message, bool json) {
  std::fputs(errorText(exit, message, json).c_str(), stderr);
  return static_cast<int>(exit);
}

// A reader that went away (head, less) is no error of ours; a full disk is.
void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return;
  if (errno == EPIPE) return;
  throw AppError(Exit::kIo, "cannot write to the standard output");
}

void addVerbs(CommandLine& line) {
  for (const auto add :
       {addPlanVerbs,      addRehearseVerb, addCaptureVerb, addDaemonVerb,   addDeviceHostVerb,
        addDevicesVerbs,   addRunVerbs,     addImportVerb,  addArchiveVerbs, addLightVerbs,
        addCalibrateVerbs, addTtfVerbs,     addFilmVerbs,   addSheetVerbs,   addRenderVerb,
        addSynthVerbs,     addDoctorVerb,   addBrdfVerbs,   addStbrdfVerbs,  addTwinVerbs,
        addAlertsVerbs})
    add(line.root());
}

int runVerb(CommandLine& line, int argc, char** argv, Signals& signals) {
  const GlobalOptions& options = line.options();
  devices::RealClock clock;
  ProgressLine progress(clock, isatty(STDERR_FILENO) == 1 && !options.quiet && !options.json);
  signals.onStop([&progress] { progress.askToStop(); });
  std::optional<tbb::global_control> threads;
  if (options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(options.threads));
  Context context{.options = options,
                  .verb = line.verbName(),
                  .command = quoted(argc, argv),
                  .arguments = {argv + 1, argv + argc},
                  .out = Output(line.verbName(), options.json, options.quiet),
                  .progress = progress,
                  .clock = clock,
                  .signals = signals};
  struct Release {  // the handler must not outlive what it calls
    Signals& signals;
    ~Release() { signals.onStop({}); }
  } release{signals};
  line.run(context);
  progress.clear();
  if (!context.answered) print(context.out.text());
  return context.exit_code;
}

// Pictures of a few megabytes come and go by the thousand. Given back to the system each time,
// their pages cost more to fault in again than the work on them: half of a texture's build.
void keepFreedMemory() {
  constexpr int kPictureBytesMax = 32 << 20, kKeptBytes = 512 << 20;
  mallopt(M_MMAP_THRESHOLD, kPictureBytesMax);
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
  mallopt(M_ARENA_MAX, 2);
}

int run(int argc, char** argv) {
  keepFreedMemory();
  Signals signals;
  CommandLine line;
  addVerbs(line);
  const auto json = [&line] { return line.options().json; };
  try {
    if (const auto text = line.parse(argc, argv)) {
      print(*text);
      return 0;
    }
    return runVerb(line, argc, argv, signals);
  } catch (const Stopped&) {
    return 128 + (signals.received() != 0 ? signals.received() : SIGINT);
  } catch (const Failure& failure) {
    return fail(failure.exit(), failure.what(), json());
  } catch (const std::bad_alloc&) {
    return fail(Exit::kTemporary, "out of memory", json());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.code() == std::errc::permission_denied ? Exit::kPermission : Exit::kIo,
                error.what(), json());
  } catch (const std::exception& error) {
    return fail(Exit::kBug, std::string("this is a bug of ours, please report it: ") + error.what(),
                json());
  }
}

}  // namespace
}  // namespace patina::app

int main(int argc, char** argv) {
  const int code = patina::app::run(argc, argv);
  // A driver's call that never returned: its thread must not wake up while all is destroyed.
  if (patina::capture::callsStillOut() > 0) {
    std::fflush(nullptr);
    std::_Exit(code);
  }
  return code;
}
