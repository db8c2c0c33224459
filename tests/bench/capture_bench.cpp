// SPDX-License-Identifier: GPL-3.0-or-later
// The rhythm of a healthy camera on the real clock, alone and beside others that are in trouble:
// one call that never returns, and a camera that fails, hangs for a while and comes back by turns;
// a virtual DSLR on the recovery ladder, with its driver in a process of its own.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "capture/app/rig/host_devices.h"
#include "capture/camera_worker.h"
#include "capture/session.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "processing/image/random.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/places.h"
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

// `guest`: one more camera. Its triggers of the first `settle` are not counted: a session begins
// with opening all cameras.
Rhythm shoot(std::int64_t shots, const std::vector<Mood>& moods, Nanoseconds interval = 50ms,
             std::unique_ptr<Camera> guest = nullptr, Nanoseconds settle = {}) {
  const TempFolder folder = TempFolder::inMemory();
  RealClock clock;
  Rig rig;
  std::string rig_text = "name = \"bench\"\n";
  for (std::size_t i = 0; i < moods.size(); ++i)
    rig_text += "[[camera]]\nid = \"cam" + std::to_string(i) + "\"\nbackend = \"bench\"\n";
  if (guest) rig_text += "[[camera]]\nid = \"" + guest->caps().id + "\"\nbackend = \"bench\"\n";
  rig.spec = parseRig(rig_text, folder / "rig.toml");
  const capture::Plan plan = capture::parsePlan(
      "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"" + formatDuration(interval) +
          "\"\nduration = \"" + formatDuration(shots * interval) +
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
  if (guest) rig.cameras.push_back(std::move(guest));
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
    if (since < settle) continue;
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

// A virtual DSLR at the end of PTP/IP.
struct WiredDslr {
  std::unique_ptr<Camera> driver() {
    const RigSpec spec = parseRig(
        "camera = [{ id = 'dslr', backend = 'gphoto2', serial = '1001', call_limit = '300ms', "
        "settings = { format = 'jpeg', cycle = '50ms', host = '127.0.0.1:" +
            std::to_string(server.port()) + "' } }]\n",
        "rig.toml");
    Rig rig = rig::openHosted(spec, rig::World{}, clock, {program(), "device-host"});
    return std::move(rig.cameras[0]);
  }

  RealClock clock;
  twin::dslr::Dslr body{twin::dslr::dslrWorld(clock), {.serial = "1001"}};
  twin::dslr::PtpIpServer server{body};
};

// By turns a DSLR that behaves and one that keeps climbing its ladder, 30 s each.
void BM_LatenessBesideALadder(benchmark::State& state) {
  WiredDslr dslr;
  Rhythm calm, climbing;
  const auto add = [&](Rhythm& all, std::int64_t shots) {
    const Rhythm one = shoot(shots, {Mood::kHealthy, Mood::kHealthy}, 200ms, dslr.driver(), 3s);
    all.late_ms.insert(all.late_ms.end(), one.late_ms.begin(), one.late_ms.end());
    std::sort(all.late_ms.begin(), all.late_ms.end());
    all.status.skipped += one.status.skipped;
  };
  for (auto _ : state)
    for (std::int64_t turn = 0; turn < state.range(0); ++turn) {
      dslr.body.behave();
      add(calm, 150);
      dslr.body.misbehave(static_cast<std::uint64_t>(turn), 0.05, 300ms);
      add(climbing, 150);
    }
  report(state, "calm", calm);
  report(state, "ladder", climbing);
  state.counters["faults"] = static_cast<double>(dslr.body.truth().faults.size());
}
BENCHMARK(BM_LatenessBesideALadder)
    ->Arg(1)
    ->Arg(4)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace patina::testing
