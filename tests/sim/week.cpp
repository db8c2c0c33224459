// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/week.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <optional>

#include "capture/session.h"
#include "db/power_cut.h"
#include "devices/fault/faulty_devices.h"
#include "devices/twin/profile.h"
#include "devices/twin/twin.h"
#include "processing/image/random.h"
#include "tests/sim/oracle.h"
#include "tests/support/disk/failing_file_ops.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

constexpr int kLivesMost = 40;

// The world does not move when somebody sets the computer's clock.
class UnsteppedClock final : public devices::Clock {
 public:
  UnsteppedClock(WorldTime& time, UtcTime t0) : time_(time), t0_(t0) {}
  UtcTime utc() const override { return t0_ + time_.now(); }
  MonoTime mono() const override { return time_.clock().mono(); }
  std::string bootId() const override { return time_.clock().bootId(); }
  bool threadSafe() const override { return false; }
  devices::Wake sleepUntil(MonoTime due, std::stop_token stop) override {
    return time_.clock().sleepUntil(due, std::move(stop));
  }

 private:
  WorldTime& time_;
  UtcTime t0_;
};

class Week {
 public:
  explicit Week(std::uint64_t seed)
      : week_(drawWeek(seed)), draw_(hashSeed(seed, 0x11fe)), clock_(utcFromNs(startOf(seed))) {
    rig_ = devices::parseRig(week_.rig_toml, folder_ / "rig.toml");
    for (const auto& camera : rig_.cameras)
      rig_.patches.push_back({camera.id, devices::twin::pictureLayout(rig_, camera).patch_px});
    plan_ = capture::parsePlan(week_.plan_toml, folder_ / "plan.toml");
    faults_ = devices::parseFaults(week_.faults_toml, folder_ / "faults.toml");
    faults_.seed = seed >> 1;
    devices::checkAgainst(faults_, rig_);
  }

  WeekOutcome run(const std::function<void(const std::filesystem::path&)>& tamper) {
    for (const Trouble& trouble : week_.troubles)
      clock_.at(clock_.mono() + trouble.at, [this, trouble] { happen(trouble); });
    while (!live()) comeBack();
    if (tamper) tamper(archive());
    WeekOutcome outcome;
    outcome.problems = oracle_.judge(archive(), run_id_, t0_, week_);
    outcome.calm_steps = oracle_.calmSteps();
    outcome.log_sha256 = oracle_.logHash();
    outcome.lives = lives_;
    outcome.acknowledged = oracle_.acknowledgedCount();
    outcome.pictures = oracle_.picturesTaken();
    return outcome;
  }

 private:
  // Some hour of some day, so that windows fall everywhere.
  static std::int64_t startOf(std::uint64_t seed) {
    return 1'714'564'800'000'000'000 +
           static_cast<std::int64_t>(uniformBelow(hashSeed(seed, 0xda7e), 86'400)) * 1'000'000'000;
  }
  std::filesystem::path archive() const { return folder_ / "archive"; }
  std::filesystem::path cutLog() const { return folder_ / "cut"; }

  // One life of the program; true when the run came to its end.
  bool live() {
    if (++lives_ > kLivesMost) throw std::runtime_error("it does not come to its end");
    std::unique_ptr<db::PowerCutFiles> logged;
    db::ArchiveOptions options;
    options.folder = archive();
    options.owner = "week";
    options.files = &disk_;
    try {
      if (week_.power_cuts) {
        logged = std::make_unique<db::PowerCutFiles>(disk_, cutLog());
        options.files = logged.get();
      }
      db::Archive archive(options);
      return isOver(archive) || session(archive);
    } catch (const db::ArchiveError&) {
      oracle_.note("the program ended");
      return false;
    }
  }

  // The last life may have come to the run's end and then to grief: the next would begin another.
  bool isOver(const db::Archive& archive) const {
    if (run_id_.empty()) return false;
    const auto state = archive.runState(run_id_);
    return state && state->run.state == "finished";
  }

  bool session(db::Archive& archive) {
    capture::SessionOptions begin;
    const capture::RunStart start = capture::startRun(plan_, rig_, archive, clock_, begin);
    if (run_id_.empty()) t0_ = start.t0_utc;
    run_id_ = start.run_id;
    UnsteppedClock world(time_, t0_);
    devices::twin::TwinOptions twin;
    twin.seed = week_.seed;
    twin.duration = plan_.duration;
    twin.start_utc = t0_;
    twin.faults = faults_;
    devices::Rig rig = devices::twin::makeTwinRig(rig_, twin, world);
    oracle_.watchTruth(rig);
    rig = devices::withFaults(std::move(rig), faults_, clock_.mono() - time_.now(), clock_);
    oracle_.watchDelivery(rig);
    capture::SessionHooks hooks;
    hooks.on_acknowledged = [&](const db::FrameRow& frame) { oracle_.acknowledged(frame); };
    hooks.on_status = [&](const capture::SessionStatus& s) {
      oracle_.note("step " + std::to_string(s.step) + " captured " + std::to_string(s.captured) +
                   " skipped " + std::to_string(s.skipped) + " missed " + std::to_string(s.missed) +
                   " failed " + std::to_string(s.failed) + " held " + std::to_string(s.held));
    };
    const auto summary = capture::runSession(plan_, rig, archive, clock_, start, hooks);
    oracle_.note(summary.end);
    return summary.end == "finished";
  }

  void happen(const Trouble& trouble) {
    const std::int64_t now = disk_.calls(), soon = 1 + static_cast<std::int64_t>(trouble.seed % 60);
    switch (trouble.what) {
      case Mishap::kPowerCut:
        cut_seed_ = trouble.seed;
        [[fallthrough]];
      case Mishap::kKill:
        disk_.unplugFrom(now + soon);
        return;
      case Mishap::kUnplugged:
        disk_.unplugFrom(now + soon);
        away_until_ = time_.now() + trouble.length;
        return;
      case Mishap::kFull:
        disk_.fillUp();
        clock_.at(clock_.mono() + trouble.length, [this] { disk_.heal(); });
        return;
      case Mishap::kOneError:
        disk_.failCall(now + soon, EIO);
        return;
      case Mishap::kClockStep:
        clock_.stepUtc(trouble.length);
        return;
      case Mishap::kSuspend:
        clock_.suspend(trouble.length);
        return;
    }
  }

  // Somebody starts the program again, at once or after a while.
  void comeBack() {
    const Nanoseconds off = static_cast<std::int64_t>(draw_.below(3)) * week_.interval +
                            week_.interval / 7 +
                            std::max(Nanoseconds{0}, away_until_ - time_.now());
    away_until_ = {};
    if (cut_seed_) {
      db::cutPower(cutLog(), *cut_seed_);
      cut_seed_.reset();
    }
    if (week_.reboots && draw_.chance(60))
      time_.reboot(off);
    else
      clock_.advance(off);
    disk_.heal();
    week_.healed = std::max(week_.healed, time_.now() + warmingUp());
  }

  // A lamp that is kept on is as cold after a restart as it was at the run's start, while the run
  // may have learned it as warm as it can be by now: until that is within half of the band (the
  // rest is the noise of a small patch), its light is rightly held.
  Nanoseconds warmingUp() const {
    if (plan_.light_check.mode == capture::LightMode::kUncontrolled) return {};
    const std::vector<std::string>& at_rest = plan_.sweeps.back().lights.back();
    if (std::ranges::none_of(rig_.lights, [&](const devices::LightSpec& light) {
          return light.between == devices::Between::kKeep &&
                 std::ranges::find(at_rest, light.id) != at_rest.end();
        }))
      return {};
    const auto& lamp = devices::twin::referenceProfile().lamp;
    const double tau_s = toSeconds(lamp.warm_up_tau);
    const double cold_at_best = std::exp(-toSeconds(time_.now()) / tau_s);
    const double cold_at_most = cold_at_best + plan_.light_check.band / 2 / lamp.warm_up;
    return cold_at_most < 1 ? fromSeconds(-tau_s * std::log(cold_at_most)) : Nanoseconds{};
  }

  TempFolder folder_ = TempFolder::inMemory();
  WeekPlan week_;
  Draw draw_;
  devices::VirtualClock clock_;
  WorldTime time_{clock_};
  Oracle oracle_{time_};
  FailingFileOps disk_;
  devices::RigSpec rig_;
  capture::Plan plan_;
  devices::FaultPlan faults_;
  std::string run_id_;
  UtcTime t0_;
  Nanoseconds away_until_{};
  std::optional<std::uint64_t> cut_seed_;
  int lives_ = 0;
};

}  // namespace

WeekOutcome runWeek(std::uint64_t seed,
                    const std::function<void(const std::filesystem::path&)>& tamper) {
  return Week(seed).run(tamper);
}

}  // namespace patina::testing
