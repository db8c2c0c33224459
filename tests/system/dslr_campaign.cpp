// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/dslr_campaign.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <map>

#include "capture/app/rig/host_devices.h"
#include "capture/camera_worker.h"
#include "db/archive_care.h"
#include "db/archive_reader.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "devices/twin/twin_devices.h"
#include "tests/support/places.h"
#include "tests/support/usb/usb_camera.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;
using twin::dslr::Dslr;

constexpr int kShotsAPart = 250;  // with one wiring
constexpr double kFaultsAnOperation = 0.008;
constexpr Nanoseconds kLongestFault = 300ms;
// Every call but an opening. On the simulated bus each transfer goes through this process: a
// camera's settings are a hundred of them.
constexpr Nanoseconds kCallLimit = 300ms, kCallLimitOnUsb = 1s;
constexpr Nanoseconds kOpening = 10s;  // devices/host/hosted_devices.h
// A process is killed in milliseconds, but on two processors others may be first.
constexpr Nanoseconds kSlack = 500ms;
constexpr double kGrowthMaxBytes = 24e6;  // of a driver: what the allocator and a decoder keep

Nanoseconds callLimit(const DslrWiring& wiring) {
  return wiring.usb ? kCallLimitOnUsb : kCallLimit;
}

// One a process: programs look at it from the first call on.
UsbBus& bus() {
  static UsbBus* const kBus = new UsbBus;
  return *kBus;
}

// A finger on the camera's cable release.
class Line final : public Trigger {
 public:
  Line(Dslr& camera, Clock& clock) : camera_(camera), clock_(clock) {}
  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    const MonoTime now = clock_.mono();
    if (!camera_.pressShutter()) return fail(Errc::kBusy, "the camera does not hear its line");
    return now;
  }
  Result<void> recover() override { return {}; }

 private:
  const std::string id_ = "line";
  Dslr& camera_;
  Clock& clock_;
};

// What all parts together came to.
struct Tally {
  std::vector<std::string> broken;
  std::string wirings;
  std::size_t files_due = 0, frames = 0, pictures = 0, on_card = 0, lost = 0, faults = 0;

  void add(const DslrWiring& wiring, int shots, const DslrVerdict& v,
           const twin::dslr::Truth& truth) {
    wirings.append(wirings.empty() ? "" : "; ").append(wiring.text());
    broken.insert(broken.end(), v.broken.begin(), v.broken.end());
    if (!wiring.memory && v.lost_with_power > 0) broken.emplace_back("a card lost files");
    files_due += static_cast<std::size_t>(shots) * wiring.files();
    frames += v.frames;
    pictures += truth.pictures.size();
    on_card += v.on_card;
    lost += v.lost_with_power;
    faults += truth.faults.size();
  }
  std::string text() const {
    return std::to_string(files_due) + " files due, " + std::to_string(frames) +
           " in the archive, " + std::to_string(pictures) + " pictures taken, " +
           std::to_string(on_card) + " files left behind, " + std::to_string(lost) +
           " lost with the power, " + std::to_string(faults) + " faults";
  }
};

}  // namespace

int numberFrom(const char* variable, int fallback) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : fallback;
}

void DslrCampaign::takeAnotherBody() {
  twin::dslr::DslrOptions options;
  options.serial = "1001";
  options.shutter_count = camera_ ? camera_->truth().shutter_count : 0;
  camera_ = std::make_unique<Dslr>(world_, options);
  first_run_ = run_ids_.size();
}

RigSpec DslrCampaign::rigOf(const DslrWiring& wiring, const std::string& host) const {
  const std::string settings = "format = \"" + wiring.format + "\", cycle = \"50ms\"" +
                               (wiring.memory ? ", target = \"memory\"" : "") +
                               (wiring.line ? ", shutter = \"external\"" : "") +
                               (host.empty() ? "" : ", host = \"" + host + "\"");
  return parseRig(
      "name = \"bench\"\n[[camera]]\nid = \"cam0\"\nbackend = \"gphoto2\"\nserial = \"1001\"\n"
      "call_limit = \"" +
          formatDuration(callLimit(wiring)) + "\"\nsettings = { " + settings +
          " }\n[[light]]\nid = \"key\"\nbackend = \"twin\"\n"
          "[[light]]\nid = \"fill\"\nbackend = \"twin\"\n[twin]\nsize = \"64x48\"\n" +
          (wiring.line ? "[[trigger]]\nid = \"line\"\nbackend = \"serial\"\n"
                         "cameras = [\"cam0\"]\naddress = \"/dev/line\"\n"
                       : ""),
      folder_ / "rig.toml");
}

// Lamps and shutter line are those of the world that the camera is in.
Rig DslrCampaign::makeRig(const RigSpec& spec, Nanoseconds call_limit) {
  RigSpec camera_alone = spec;
  camera_alone.lights.clear();
  camera_alone.triggers.clear();
  rig::World world;
  world.start_utc = clock_.utc();
  Rig made = rig::openHosted(camera_alone, world, clock_, {program().string(), "device-host"});
  made.spec = spec;
  for (auto& camera : made.cameras)
    camera = std::make_unique<TimedCamera>(std::move(camera), CallDeadlines{call_limit, kOpening},
                                           clock_, times_);
  for (std::size_t i = 0; i < spec.lights.size(); ++i)
    made.lights.push_back(twin::makeTwinLight(world_, i));
  if (!spec.triggers.empty()) made.triggers.push_back(std::make_unique<Line>(*camera_, clock_));
  return made;
}

capture::Plan DslrCampaign::planOf(int shots, int interval_ms) const {
  const int steps = (shots + kShotsAStep - 1) / kShotsAStep;
  return capture::parsePlan(
      "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"" + std::to_string(interval_ms) +
          "ms\"\nduration = \"" + std::to_string(steps * interval_ms) +
          "ms\"\n[[sweep]]\nlights = [[\"key\"],[\"fill\"]]\nexposures = [\"1/100\", \"1/50\"]\n"
          "[light_check]\nmode = \"uncontrolled\"\n",
      folder_ / "plan.toml");
}

capture::SessionSummary DslrCampaign::run(const DslrWiring& wiring, int shots, int interval_ms) {
  std::unique_ptr<twin::dslr::PtpIpServer> server;
  std::unique_ptr<UsbCamera> cable;
  if (wiring.usb)
    cable = std::make_unique<UsbCamera>(bus(), *camera_, 1);
  else
    server = std::make_unique<twin::dslr::PtpIpServer>(*camera_);
  const RigSpec spec = rigOf(wiring, server ? "127.0.0.1:" + std::to_string(server->port()) : "");
  const capture::Plan plan = planOf(shots, interval_ms);
  db::ArchiveOptions options;
  options.folder = folder_ / "archive";
  options.owner = "test";
  db::Archive archive(options);
  capture::SessionOptions anew;
  anew.new_run = true;
  const auto start = capture::startRun(plan, spec, archive, clock_, anew);
  run_ids_.push_back(start.run_id);
  capture::SessionHooks hooks;
  hooks.on_step = [this](const db::StepRow&) { drivers_.look(); };
  hooks.on_thumbnail = [this](const Sha256&, const Bytes&) { ++thumbnails_; };
  Rig rig = makeRig(spec, callLimit(wiring));
  auto summary = capture::runSession(plan, rig, archive, clock_, start, hooks);
  // A camera that was being opened when the session ended: its process and descriptors are still
  // there, and it uses our clock.
  while (capture::callsStillOut() > 0) clock_.sleepUntil(clock_.mono() + 1ms, {});
  return summary;
}

DslrVerdict DslrCampaign::verdict() {
  camera_->behave();
  const std::vector<std::string> own(run_ids_.begin() + static_cast<std::ptrdiff_t>(first_run_),
                                     run_ids_.end());
  return judge(folder_ / "archive", own, camera_->truth(), {"key", "fill"}, 1ms);
}

std::string DslrCampaign::story() const {
  std::map<std::string, int> decisions, rungs;
  const db::ArchiveReader reader(folder_ / "archive");
  for (const std::string& run_id : run_ids_) {
    for (const db::StepRow& step : reader.steps(run_id)) ++decisions[db::name(step.decision)];
    for (const db::EventRow& event : reader.events(run_id)) {
      if (event.kind != "recover") continue;
      const std::string rung = event.detail.substr(event.detail.find(": ") + 2);
      ++rungs[rung.substr(0, rung.find(" after"))];
    }
  }
  std::string text = "steps:";
  for (const auto& [decision, n] : decisions) text += " " + std::to_string(n) + " " + decision;
  text += "; rungs:";
  for (const auto& [rung, n] : rungs) text += " " + std::to_string(n) + " " + rung;
  return text;
}

// Each part has a body of its own: what a driver left on the card is listed, file by file, at every
// opening, and each of these questions may be the one that fails.
void DslrCampaign::misbehaveThroughout(bool usb) {
  const int shots = numberFrom("PATINA_DSLR_SHOTS", 50);
  const auto seed = static_cast<std::uint64_t>(numberFrom("PATINA_DSLR_SEED", 1)) +
                    static_cast<std::uint64_t>(GetParam());
  if (usb) bus();
  const auto before = resourcesOf(::getpid(), folder_ / "archive");
  Tally all;
  for (int done = 0, part = 0; done < shots; done += kShotsAPart, ++part) {
    const DslrWiring wiring = wiringOf(usb, seed, static_cast<std::uint64_t>(part));
    const int of_part = std::min(kShotsAPart, shots - done);
    takeAnotherBody();
    camera_->misbehave(hashSeed(seed, static_cast<std::uint64_t>(part)), kFaultsAnOperation,
                       kLongestFault);
    // Opening the camera takes some tenths of a second: the rest of a step may pass meanwhile.
    run(wiring, of_part, usb ? 2400 : 1200);
    all.add(wiring, of_part, verdict(), camera_->truth());
  }
  const auto after = resourcesOf(::getpid(), folder_ / "archive");
  std::printf("seed %llu (%s): %s; %s\n%s\nhere %+d descriptors, %+.1f MB; %s\n",
              static_cast<unsigned long long>(seed), all.wirings.c_str(), all.text().c_str(),
              story().c_str(), times_->text().c_str(), after->descriptors - before->descriptors,
              (after->resident_bytes - before->resident_bytes) / 1e6, drivers_.text().c_str());
  EXPECT_THAT(all.broken, ::testing::IsEmpty());
  EXPECT_GE(all.faults, static_cast<std::size_t>(shots) / 20);
  // It comes back again and again; how often in so short a time is the machine's business.
  EXPECT_TRUE(usb || all.frames >= all.files_due / 6) << all.text();
  EXPECT_LE(times_->latest(), kSlack) << times_->text();
  // Under umockdev-wrapper there are its connections, too, here and in the driver.
  EXPECT_TRUE(usb || after->descriptors <= before->descriptors + 4)
      << ::testing::PrintToString(descriptorsOf(::getpid()));
  EXPECT_TRUE(usb || drivers_.growth().descriptors <= 4);
  EXPECT_LE(drivers_.growth().resident_bytes, kGrowthMaxBytes);
  Progress progress;
  for (const auto& p : db::verify(folder_ / "archive", progress).problems)
    ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
}

}  // namespace patina::testing
