// SPDX-License-Identifier: GPL-3.0-or-later
// The rhythm of a healthy camera under the real daemon on the real clock: left in peace, and while
// one camera hangs, one comes and goes, and strangers do to its HTTP what they can. The flood is a
// process of its own. Archives lie in memory: a disk's fsync is no matter of the door's. Where we
// may mount, in a memory of their own: a rename waits for those of all others on its file system.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>

#include "capture/app/daemon/places.h"
#include "capture/app/http/sockets.h"
#include "db/archive_reader.h"
#include "db/failure.h"
#include "devices/clock.h"
#include "tests/support/child.h"
#include "tests/support/places.h"
#include "tests/support/resources.h"
#include "tests/system/mounted.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kInterval = 50ms, kWarmUp = 5s;
constexpr double kMegabyte = 1 << 20;
// The limits that this bench is there for.
constexpr double kP99Ms = 5, kMaxAboveQuietMs = 20, kGrowthMegabytes = 32;

struct Rhythm {
  std::vector<double> late_ms;  // of the healthy camera, skipped steps included; sorted
  std::vector<double> bare_ms;  // of a thread of ours that does nothing but wake; sorted
  std::int64_t skipped = 0;
  double growth_bytes = 0;  // of the daemon, from the end of its warm-up to its most
  std::string flood;        // what was done to it
};

double at(double share, const std::vector<double>& sorted) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

enum class Times { kQuiet, kBad };

class Trial {
 public:
  // `shots` are counted from the end of the warm-up on, when the flood begins.
  Trial(Times times, std::int64_t shots) : times_(times), shots_(shots + kWarmUp / kInterval) {
    writeFile(folder_ / "rig.toml", rigText());
    writeFile(folder_ / "faults.toml", faultsText());
    writeFile(folder_ / "plan.toml",
              "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"50ms\"\nduration = \"" +
                  formatDuration(shots_ * kInterval) +
                  "\"\n[[sweep]]\nlights = [[\"key\"]]\nexposures = [\"1/200\"]\n[light_check]\n"
                  "mode = \"uncontrolled\"\n");
  }

  Rhythm run() {
    begin();
    Rhythm rhythm;
    waitUntil(t0_ + kWarmUp);
    const double before = residentBytes(daemon_->pid()).value();
    double most = before;
    std::optional<Child> flood;
    if (times_ == Times::kBad) flood.emplace(floodCommand());
    wake(rhythm.bare_ms, most);
    if (flood) {
      flood->signal(SIGKILL);
      rhythm.flood = lastLine(flood->wait().out);
    }
    waitUntil(clock_.mono() + 1s);  // for the end of the session
    daemon_->signal(SIGTERM);
    daemon_->wait();
    rhythm.growth_bytes = most - before;
    readShots(rhythm);
    return rhythm;
  }

 private:
  static std::string rigText() {
    std::string rig = "name = \"bench\"\n";
    for (const char* id : {"cam0", "cam1", "cam2"})
      rig += std::string("[[camera]]\nid = \"") + id +
             "\"\nbackend = \"twin\"\nsettings = { format = \"jpeg\" }\n";
    return rig +
           "[[light]]\nid = \"key\"\nbackend = \"twin\"\nbetween = \"on\"\n"
           "[twin]\nspecimen = \"grey_card\"\nsize = \"64x48\"\nfaults = \"faults.toml\"\n";
  }

  // cam1 hangs from its second second on; cam2 is away for 200 ms twice a second.
  std::string faultsText() const {
    std::string text = "seed = 1\n";
    if (times_ == Times::kQuiet) return text;
    const Nanoseconds all = shots_ * kInterval;
    const auto fault = [&text](const char* camera, const char* kind, Nanoseconds at,
                               Nanoseconds lasts) {
      text += std::string("[[fault]]\ndevice = \"") + camera + "\"\nkind = \"" + kind +
              "\"\nat = \"" + formatDuration(at) + "\"\nduration = \"" + formatDuration(lasts) +
              "\"\n";
    };
    fault("cam1", "hang", 1s, all);
    for (Nanoseconds at = 1s; at < all; at += 500ms) fault("cam2", "lost", at, 200ms);
    return text;
  }

  void begin() {
    port_ = http::portOf(http::listenOnTcp("127.0.0.1", 0));  // free again when this returns
    daemon_.emplace(
        std::vector<std::string>{programFolder() / "patina", "daemon", "--archive", archive_,
                                 "--port", std::to_string(port_), "--start", folder_ / "plan.toml"},
        std::vector<std::string>{"RUNTIME_DIRECTORY=" + (folder_ / "run").string(),
                                 "DBUS_SYSTEM_BUS_ADDRESS=unix:path=/nowhere"});
    while (!findRun()) clock_.sleepUntil(clock_.mono() + 20ms, {});
  }

  bool findRun() {
    try {
      const db::ArchiveReader reader(archive_);
      const auto runs = reader.runs();
      if (runs.empty() || !reader.newestFrame(runs[0].id)) return false;
      run_ = runs[0].id;
      t0_ = runs[0].t0_boot;
      object_ = reader.newestFrame(run_)->sha256.hex();
      return true;
    } catch (const db::ArchiveError&) {
      return false;  // it is being made
    }
  }

  std::vector<std::string> floodCommand() const {
    const auto token =
        folder_ / "run" / (daemon::nameOfArchive(archive_) + ".token");  // of this start
    std::string text = readFile(token);
    text.pop_back();
    return {programFolder() / "tests/http_flood", std::to_string(port_), text, object_};
  }

  void waitUntil(MonoTime due) { clock_.sleepUntil(due, {}); }

  // To the end of the run: what the machine itself makes of deadlines, and what the daemon takes.
  void wake(std::vector<double>& bare_ms, double& most) {
    const MonoTime end = t0_ + shots_ * kInterval;
    for (MonoTime due = clock_.mono() + kInterval; due < end; due += kInterval) {
      waitUntil(due);
      bare_ms.push_back(1e3 * toSeconds(clock_.mono() - due));
      const auto resident = residentBytes(daemon_->pid());
      if (!resident) throw std::runtime_error("the daemon is gone: " + daemon_->wait().err);
      most = std::max(most, *resident);
    }
    std::sort(bare_ms.begin(), bare_ms.end());
  }

  static std::string lastLine(std::string text) {
    if (!text.empty()) text.pop_back();
    return text.substr(text.rfind('\n') + 1);
  }

  // A slot without its picture counts as late by all of it.
  double lateOf(const db::ArchiveReader& reader, const db::StepRow& step) const {
    for (const db::ShotRow& shot : reader.shotsOfStep(step.id))
      if (shot.device_id == "cam0" && shot.attempt == 0 && shot.state == db::ShotState::kCaptured)
        return 1e3 * toSeconds(shot.began_mono - (t0_ + *step.number * kInterval));
    return 1e3 * toSeconds(kInterval);
  }

  void readShots(Rhythm& rhythm) const {
    const db::ArchiveReader reader(archive_);
    for (const db::StepRow& step : reader.steps(run_)) {
      if (*step.number < kWarmUp / kInterval) continue;
      long long late_by_ms = 0;
      if (step.decision == db::Decision::kSkipped) {
        ++rhythm.skipped;
        std::sscanf(step.reason.c_str(), "late by %lld ms", &late_by_ms);
        rhythm.late_ms.push_back(static_cast<double>(late_by_ms));
        continue;
      }
      rhythm.late_ms.push_back(lateOf(reader, step));
    }
    std::sort(rhythm.late_ms.begin(), rhythm.late_ms.end());
  }

  Times times_;
  std::int64_t shots_;
  TempFolder folder_ = TempFolder::inMemory();
  const Mounted own_ = Mounted::tmpfs(folder_.path(), "1g");  // before anything lies in it
  std::string archive_ = folder_ / "archive";
  devices::RealClock clock_;
  int port_ = 0;
  std::optional<Child> daemon_;
  std::string run_, object_;
  MonoTime t0_;
};

void report(benchmark::State& state, const std::string& who, const Rhythm& r) {
  const auto line = [&](const std::string& what, const std::vector<double>& ms) {
    std::printf("%-8s %-8s %5zu: late p50 %.3f p99 %.3f max %.3f ms", who.c_str(), what.c_str(),
                ms.size(), at(0.5, ms), at(0.99, ms), ms.back());
  };
  line("triggers", r.late_ms);
  std::printf(", %lld skipped; memory %+.1f MB\n", static_cast<long long>(r.skipped),
              r.growth_bytes / kMegabyte);
  line("timer", r.bare_ms);
  std::printf("\n");
  state.counters[who + "_p50_ms"] = at(0.5, r.late_ms);
  state.counters[who + "_p99_ms"] = at(0.99, r.late_ms);
  state.counters[who + "_max_ms"] = r.late_ms.back();
  state.counters[who + "_skipped"] = static_cast<double>(r.skipped);
  state.counters[who + "_growth_MB"] = r.growth_bytes / kMegabyte;
}

bool hold(const char* what, double is, double limit) {
  std::printf("%s %s %.3f (at most %.3f)\n", is <= limit ? "PASS" : "FAIL", what, is, limit);
  return is <= limit;
}

// A hundred real seconds twice: 2,000 shots at 50 ms in peace, and with all that trouble.
void BM_TriggerLatenessUnderFlood(benchmark::State& state) {
  const std::int64_t shots = state.range(0);
  for (auto _ : state) {
    const Rhythm quiet = Trial(Times::kQuiet, shots).run();
    const Rhythm bad = Trial(Times::kBad, shots).run();
    if (quiet.late_ms.empty() || bad.late_ms.empty() || bad.bare_ms.empty())
      return state.SkipWithError("the healthy camera never shot");
    report(state, "quiet", quiet);
    report(state, "flooded", bad);
    std::printf("the flood: %s\n", bad.flood.c_str());
    const bool p99 = hold("p99_ms", at(0.99, bad.late_ms), kP99Ms);
    const bool max =
        hold("max_ms above quiet", bad.late_ms.back() - quiet.late_ms.back(), kMaxAboveQuietMs);
    const bool growth = hold("growth_MB", bad.growth_bytes / kMegabyte, kGrowthMegabytes);
    state.SetLabel(p99 && max && growth ? "PASS" : "FAIL");
    std::fflush(stdout);
  }
}
BENCHMARK(BM_TriggerLatenessUnderFlood)
    ->Arg(300)
    ->Arg(2000)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace patina::testing
