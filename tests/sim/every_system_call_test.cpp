// SPDX-License-Identifier: GPL-3.0-or-later
// A whole session on the twin while the system itself fails: each open, pwrite, fsync, rename,
// close and statvfs once, with each error, SQLite's too. A session that ends is started again, as
// its supervisor would; nothing it acknowledged may be lost.
// PATINA_CALL_FRAMES is the length of the run; the long form sets it.
#include <gmock/gmock.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/sim/simulation.h"
#include "tests/support/disk/archive_life.h"
#include "tests/support/disk/failing_system_calls.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;

int framesAskedFor() {
  const char* text = std::getenv("PATINA_CALL_FRAMES");
  return text != nullptr ? std::atoi(text) : 3;
}

// The short form lets each call fail with one of the errors in turn; the long one with each.
bool isTurnOf(int turn, std::int64_t k) {
  return std::getenv("PATINA_CALL_FRAMES") != nullptr || k % 4 == turn;
}

struct Outcome {
  std::int64_t calls = 0;
  std::string call;  // the name of the one that failed
  int restarts = 0;
  bool whole = false;  // every step captured, in one life
};

Outcome failCall(std::int64_t k, int error, int frames) {
  Simulation sim({.interval = "1min",
                  .duration = std::to_string(frames) + "min",
                  .between = "on",
                  .size = "32x32"});
  Judge judge;
  Outcome outcome;
  {
    FailingSystemCalls calls(sim.archive_options.folder);
    calls.failCall(k, error);
    for (bool ended = false; !ended;) try {
        const auto summary = sim.run([&](capture::SessionHooks& hooks) {
          hooks.on_acknowledged = [&](const db::FrameRow& frame) {
            judge.note({frame.sha256.hex(), -1, 0, frame.shot_id});
          };
        });
        ended = true;
        outcome.whole = outcome.restarts == 0 && summary.last.captured == frames;
      } catch (const db::ArchiveError&) {
        if (++outcome.restarts == 4) throw;
        sim.clock.advance(2s);
      }
    outcome.calls = calls.calls();
    outcome.call = calls.failed();
    EXPECT_EQ(calls.syncsAfterFailure(), 0) << "a descriptor was synced again after EIO";
  }
  EXPECT_THAT(judge.judgeRecovered(sim.archive_options.folder), IsEmpty());
  sim.expectWhole();
  return outcome;
}

void failEveryCall(int turn, int error, const char* name) {
  const int frames = framesAskedFor();
  std::map<std::string, int> failed, restarted;
  bool met = true;  // until a run ends before it meets its fault
  for (std::int64_t k = 1; met; ++k) {
    if (!isTurnOf(turn, k)) continue;
    SCOPED_TRACE(std::string(name) + " at call " + std::to_string(k));
    const Outcome outcome = failCall(k, error, frames);
    met = outcome.calls >= k;
    if (!outcome.call.empty()) ++failed[outcome.call];
    if (outcome.restarts > 0) ++restarted[outcome.call];
    const bool harmless = error == EINTR || error == FailingSystemCalls::kShortWrite ||
                          outcome.call == "close" || outcome.call.empty();
    EXPECT_TRUE(outcome.whole || !harmless) << outcome.call << " need not have disturbed anybody";
    if (::testing::Test::HasFailure()) return;
  }
  std::printf("%s in a run of %d frames:", name, frames);
  for (const auto& [call, count] : failed)
    std::printf(" %s %d (%d ended the session)", call.c_str(), count, restarted[call]);
  std::printf("\n");
  const bool writes = error == FailingSystemCalls::kShortWrite;
  EXPECT_GE(failed.size(), writes ? 1u : 5u) << "a kind of call was never reached";
}

TEST(EverySystemCall, MayFailWithAnInputOutputError) { failEveryCall(0, EIO, "EIO"); }
TEST(EverySystemCall, MayFailOnAFullDisk) { failEveryCall(1, ENOSPC, "ENOSPC"); }
TEST(EverySystemCall, MayBeInterrupted) { failEveryCall(2, EINTR, "EINTR"); }
TEST(EverySystemCall, MayWriteShort) { failEveryCall(3, FailingSystemCalls::kShortWrite, "short"); }

}  // namespace
}  // namespace patina::testing
