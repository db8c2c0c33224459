// SPDX-License-Identifier: GPL-3.0-or-later
// A plan on a virtual DSLR through libgphoto2, its driver in a process of its own, while the camera
// does everything wrong it can, at random. PATINA_DSLR_SHOTS: how many shots (50),
// PATINA_DSLR_SEED: the first seed (1).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <mutex>

#include "capture/app/rig/host_devices.h"
#include "capture/session.h"
#include "db/archive_care.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "devices/twin/twin_devices.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/resources.h"
#include "tests/support/temp_folder.h"
#include "tests/system/dslr_oracle.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;
using twin::dslr::Dslr;

constexpr int kShotsAStep = 4;  // two lamps, two exposures
constexpr Nanoseconds kCallLimit = 4s;
// A process is killed in milliseconds, but on two processors others may be first.
constexpr Nanoseconds kSlack = 500ms;

int numberFrom(const char* variable, int fallback) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : fallback;
}

// The longest that calls took beyond their deadlines.
struct Lateness {
  std::mutex mutex;
  Nanoseconds worst = -1h;
  std::string call;
  int calls = 0;
};

class TimedCamera final : public Camera {
  template <class Call>
  auto timed(const char* name, Nanoseconds limit, Call call) {
    const MonoTime begun = clock_.mono();
    auto answer = call();
    const Nanoseconds late = clock_.mono() - begun - limit;
    const std::lock_guard lock(lateness_->mutex);
    ++lateness_->calls;
    if (late > lateness_->worst) {
      lateness_->worst = late;
      lateness_->call = name;
    }
    return answer;
  }

 public:
  TimedCamera(std::unique_ptr<Camera> camera, Clock& clock, std::shared_ptr<Lateness> lateness)
      : camera_(std::move(camera)), clock_(clock), lateness_(std::move(lateness)) {}
  const CameraCaps& caps() const override { return camera_->caps(); }
  Result<Applied> configure(const Exposure& e) override {
    return timed("configure", kCallLimit, [&] { return camera_->configure(e); });
  }
  Result<Ticket> trigger(const ShotRequest& r) override {
    return timed("trigger", kCallLimit, [&] { return camera_->trigger(r); });
  }
  Result<std::vector<RawFrame>> collect(const Ticket& t, MonoTime deadline) override {
    return timed("collect", std::max<Nanoseconds>(deadline - clock_.mono(), 0ns),
                 [&] { return camera_->collect(t, deadline); });
  }
  Result<void> release(const RawFrame& f) override {
    return timed("release", kCallLimit, [&] { return camera_->release(f); });
  }
  Result<std::vector<CameraEvent>> poll() override {
    return timed("poll", 2 * kCallLimit, [&] { return camera_->poll(); });
  }
  Result<void> recover(Rung rung) override {
    // A driver that does not manage is asked once more in a new process.
    return timed("recover", 2 * kCallLimit, [&] { return camera_->recover(rung); });
  }

 private:
  std::unique_ptr<Camera> camera_;
  Clock& clock_;
  std::shared_ptr<Lateness> lateness_;
};

class DslrCampaign : public ::testing::TestWithParam<int> {
 protected:
  DslrCampaign() {
    rig_spec_ = parseRig(
        "name = \"bench\"\n[[camera]]\nid = \"cam0\"\nbackend = \"gphoto2\"\nserial = \"1001\"\n"
        "call_limit = \"4s\"\nsettings = { format = \"jpeg\", cycle = \"50ms\", host = "
        "\"127.0.0.1:" +
            std::to_string(server_.port()) +
            "\" }\n[[light]]\nid = \"key\"\nbackend = \"twin\"\n"
            "[[light]]\nid = \"fill\"\nbackend = \"twin\"\n[twin]\nsize = \"64x48\"\n",
        folder_ / "rig.toml");
  }
  // The lamps are those of the world that the camera sees.
  Rig makeRig() {
    RigSpec camera_alone = rig_spec_;
    camera_alone.lights.clear();
    rig::World world;
    world.start_utc = clock_.utc();
    Rig made = rig::openHosted(camera_alone, world, clock_,
                               {std::getenv("PATINA_PROGRAM"), "device-host"});
    made.spec = rig_spec_;
    for (auto& camera : made.cameras)
      camera = std::make_unique<TimedCamera>(std::move(camera), clock_, lateness_);
    for (std::size_t i = 0; i < rig_spec_.lights.size(); ++i)
      made.lights.push_back(twin::makeTwinLight(world_, i));
    return made;
  }
  // Opening the camera takes a second: a step may pass meanwhile.
  void run(int shots, int interval_ms = 1200) {
    const int steps = (shots + kShotsAStep - 1) / kShotsAStep;
    const capture::Plan plan = capture::parsePlan(
        "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"" + std::to_string(interval_ms) +
            "ms\"\nduration = \"" + std::to_string(steps * interval_ms) +
            "ms\"\n[[sweep]]\nlights = [[\"key\"],[\"fill\"]]\nexposures = [\"1/100\", \"1/50\"]\n"
            "[light_check]\nmode = \"uncontrolled\"\n",
        folder_ / "plan.toml");
    db::ArchiveOptions options;
    options.folder = folder_ / "archive";
    options.owner = "test";
    db::Archive archive(options);
    const auto start = capture::startRun(plan, rig_spec_, archive, clock_, {});
    run_id_ = start.run_id;
    Rig rig = makeRig();
    summary_ = capture::runSession(plan, rig, archive, clock_, start, {});
  }
  DslrVerdict verdict() {
    camera_.behave();
    return judge(folder_ / "archive", run_id_, camera_.truth(), {"key", "fill"}, 1ms);
  }

  TempFolder folder_ = TempFolder::inMemory();
  RealClock clock_;
  std::shared_ptr<twin::World> world_ = twin::dslr::dslrWorld(clock_);
  Dslr camera_{world_, [] {
                 twin::dslr::DslrOptions options;
                 options.serial = "1001";
                 return options;
               }()};
  twin::dslr::PtpIpServer server_{camera_};
  RigSpec rig_spec_;
  std::shared_ptr<Lateness> lateness_ = std::make_shared<Lateness>();
  std::string run_id_;
  capture::SessionSummary summary_;
};

TEST_F(DslrCampaign, AWellBehavedCameraGivesEveryShot) {
  run(8, 4000);
  const DslrVerdict v = verdict();
  EXPECT_THAT(v.broken, ::testing::IsEmpty());
  EXPECT_EQ(v.frames, 8u);
  EXPECT_LE(v.on_card, 1u);  // whose release the session's end overtook
  EXPECT_EQ(summary_.last.captured, 2);
}

TEST_P(DslrCampaign, NoPictureIsLostDoubledOrMisplacedWhateverTheCameraDoes) {
  const int shots = numberFrom("PATINA_DSLR_SHOTS", 50);
  const auto seed = static_cast<std::uint64_t>(numberFrom("PATINA_DSLR_SEED", 1)) +
                    static_cast<std::uint64_t>(GetParam());
  camera_.misbehave(seed, 0.008, 300ms);
  const auto before = resourcesOf(::getpid(), folder_ / "archive");
  run(shots);
  const auto after = resourcesOf(::getpid(), folder_ / "archive");
  const DslrVerdict v = verdict();
  const twin::dslr::Truth truth = camera_.truth();
  std::printf(
      "seed %llu: %d shots due, %zu frames, %zu pictures taken, %zu left on the card, "
      "%zu faults; the latest of %d calls: %s, %.3f s %s its limit; %+d descriptors, "
      "%+.1f MB\n",
      static_cast<unsigned long long>(seed), shots, v.frames, truth.pictures.size(), v.on_card,
      truth.faults.size(), lateness_->calls, lateness_->call.c_str(),
      std::abs(toSeconds(lateness_->worst)), lateness_->worst > 0ns ? "over" : "within",
      after->descriptors - before->descriptors,
      (after->resident_bytes - before->resident_bytes) / 1e6);
  EXPECT_THAT(v.broken, ::testing::IsEmpty());
  EXPECT_GE(truth.faults.size(), static_cast<std::size_t>(shots) / 20);
  // It comes back again and again; how often in so short a time is the machine's business.
  EXPECT_GE(v.frames, static_cast<std::size_t>(shots) / 12);
  EXPECT_LE(lateness_->worst, kSlack) << lateness_->call;
  EXPECT_LE(after->descriptors, before->descriptors + 4);
  Progress progress;
  for (const auto& p : db::verify(folder_ / "archive", progress).problems)
    ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
}

INSTANTIATE_TEST_SUITE_P(Seeds, DslrCampaign, ::testing::Range(0, 4));

}  // namespace
}  // namespace patina::testing
