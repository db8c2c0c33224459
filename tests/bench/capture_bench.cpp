// SPDX-License-Identifier: GPL-3.0-or-later
// The rhythm of a healthy camera on the real clock, alone and beside two that are in trouble: one
// call that never returns, and a camera that fails, hangs for a while and comes back by turns.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "capture/camera_worker.h"
#include "capture/session.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;

constexpr SizePx kSize{64, 48};
constexpr Nanoseconds kReadout = 10ms;

// Where calls hang that are never to return, until the process has seen enough.
class Hell {
 public:
  void stay() {
    std::unique_lock lock(mutex_);
    over_.wait(lock, [this] { return frozen_over_; });
  }
  void freezeOver() {
    const std::lock_guard lock(mutex_);
    frozen_over_ = true;
    over_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable over_;
  bool frozen_over_ = false;
};

enum class Mood { kHealthy, kHung, kFlapping };

// Small pictures after 10 ms, by the host's own clock.
class BenchCamera final : public Camera {
 public:
  BenchCamera(const std::string& id, Mood mood, Clock& clock, std::shared_ptr<Hell> hell)
      : mood_(mood), clock_(clock), hell_(std::move(hell)) {
    caps_.id = id;
    caps_.model = "bench";
    caps_.size = kSize;
    caps_.extensions = {"jpg"};
    caps_.exposure_min = 100us;
    caps_.exposure_max = 1s;
    caps_.cycle = kReadout;
    caps_.bytes_a_shot = 4000;
  }
  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override {
    exposure_ = exposure;
    return Applied{exposure};
  }
  Result<Ticket> trigger(const ShotRequest& request) override {
    const bool off = mood_ == Mood::kFlapping && request.sequence % 7 < 3;
    if (off) return fail(Errc::kLost, caps_.id + ": trigger: session lost");
    if (triggers_) triggers_->push_back(clock_.mono());
    return Ticket{request.key, request.sequence, clock_.utc(), clock_.mono()};
  }
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    if (mood_ == Mood::kHung && ++shots_ > 20) hell_->stay();
    if (mood_ == Mood::kFlapping && ticket.sequence % 11 == 0) {
      clock_.sleepUntil(deadline, {});  // past the slot: at 50 ms a deadline lies far behind it
      return fail(Errc::kTimeout, caps_.id + ": collect: no picture by the deadline");
    }
    clock_.sleepUntil(ticket.began_mono + exposure_.time + kReadout, {});
    RawFrame frame;
    frame.ext = "jpg";
    frame.bytes = picture(ticket.sequence);
    frame.sequence = ticket.sequence;
    frame.utc = ticket.began_utc + exposure_.time / 2;
    frame.mono = ticket.began_mono + exposure_.time / 2;
    return std::vector<RawFrame>{std::move(frame)};
  }
  Result<void> release(const RawFrame&) override { return {}; }
  Result<std::vector<CameraEvent>> poll() override { return std::vector<CameraEvent>{}; }
  Result<void> recover(Rung) override {
    if (mood_ == Mood::kFlapping) clock_.sleepUntil(clock_.mono() + 80ms, {});
    return {};
  }

  std::vector<MonoTime>* triggers_ = nullptr;  // written by its worker, read after the session

 private:
  static Bytes picture(std::uint64_t sequence) {
    Image<std::uint8_t> grey(kSize.width, kSize.height, 3);
    for (std::size_t i = 0; i < grey.texels().size(); ++i)
      grey.texels()[i] = static_cast<std::uint8_t>(uniformBelow(hashSeed(sequence, i), 200));
    return encodeJpeg(std::as_const(grey).view(), 90);
  }

  Mood mood_;
  Clock& clock_;
  std::shared_ptr<Hell> hell_;
  CameraCaps caps_;
  Exposure exposure_;
  int shots_ = 0;
};

struct Rhythm {
  std::vector<double> late_ms;  // of the healthy camera's triggers, sorted
  capture::SessionStatus status;
};

Rhythm shoot(std::int64_t shots, const std::vector<Mood>& moods) {
  const TempFolder folder = TempFolder::inMemory();
  RealClock clock;
  Rig rig;
  std::string rig_text = "name = \"bench\"\n";
  for (std::size_t i = 0; i < moods.size(); ++i)
    rig_text += "[[camera]]\nid = \"cam" + std::to_string(i) + "\"\nbackend = \"bench\"\n";
  rig.spec = parseRig(rig_text, folder / "rig.toml");
  const Nanoseconds interval = 50ms;
  const capture::Plan plan = capture::parsePlan(
      "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"50ms\"\nduration = \"" +
          formatDuration(shots * interval) +
          "\"\n[[sweep]]\nlights = [[]]\nexposures = [\"1/200\"]\n[light_check]\n"
          "mode = \"uncontrolled\"\n",
      folder / "plan.toml");
  const auto hell = std::make_shared<Hell>();
  std::vector<MonoTime> triggers;
  triggers.reserve(static_cast<std::size_t>(shots));
  for (std::size_t i = 0; i < moods.size(); ++i) {
    auto camera = std::make_unique<BenchCamera>("cam" + std::to_string(i), moods[i], clock, hell);
    if (i == 0) camera->triggers_ = &triggers;
    rig.cameras.push_back(std::move(camera));
  }
  db::ArchiveOptions options;
  options.folder = folder / "archive";
  options.owner = "bench";
  db::Archive archive(options);
  const auto start = capture::startRun(plan, rig.spec, archive, clock, {});
  const MonoTime t0 = archive.runState(start.run_id)->run.t0_boot;
  Rhythm rhythm;
  rhythm.status = capture::runSession(plan, rig, archive, clock, start, {}).last;
  hell->freezeOver();
  while (capture::callsStillOut() > 0) clock.sleepUntil(clock.mono() + 1ms, {});
  for (const MonoTime fired : triggers) {
    const Nanoseconds since = fired - t0;
    rhythm.late_ms.push_back(1e-6 * static_cast<double>((since % interval).count()));
  }
  std::sort(rhythm.late_ms.begin(), rhythm.late_ms.end());
  return rhythm;
}

void report(benchmark::State& state, const std::string& who, const Rhythm& rhythm) {
  const auto& late = rhythm.late_ms;
  if (late.empty()) return state.SkipWithError("the healthy camera never shot");
  const auto at = [&](double share) {
    return late[static_cast<std::size_t>(share * static_cast<double>(late.size() - 1))];
  };
  state.counters[who + "_shots"] = static_cast<double>(late.size());
  state.counters[who + "_p50_ms"] = at(0.5);
  state.counters[who + "_p99_ms"] = at(0.99);
  state.counters[who + "_max_ms"] = late.back();
  state.counters[who + "_skipped"] = static_cast<double>(rhythm.status.skipped);
}

// A hundred real seconds twice: 2,000 shots at 50 ms without trouble, and with it.
void BM_TriggerLateness(benchmark::State& state) {
  const std::int64_t shots = state.range(0);
  for (auto _ : state) {
    report(state, "well", shoot(shots, {Mood::kHealthy, Mood::kHealthy, Mood::kHealthy}));
    report(state, "trouble", shoot(shots, {Mood::kHealthy, Mood::kHung, Mood::kFlapping}));
  }
}
BENCHMARK(BM_TriggerLateness)
    ->Arg(300)
    ->Arg(2000)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace patina::testing
