// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions on virtual DSLRs whose shutters hang on a line (`shutter = "external"`): the drivers arm
// and wait, the line fires. And a pair of files of which one does not come.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "capture/app/rig/host_devices.h"
#include "capture/session.h"
#include "db/archive_care.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/temp_folder.h"
#include "tests/system/dslr_oracle.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;
using twin::dslr::Dslr;

struct Body {
  Body(Clock& clock, const std::string& serial)
      : camera(twin::dslr::dslrWorld(clock), [&] {
          twin::dslr::DslrOptions options;
          options.serial = serial;
          return options;
        }()) {}
  std::string table(const std::string& id, const std::string& settings) const {
    return "[[camera]]\nid = \"" + id + "\"\nbackend = \"gphoto2\"\nserial = \"" +
           camera.options().serial + "\"\ncall_limit = \"4s\"\nsettings = { host = \"127.0.0.1:" +
           std::to_string(server.port()) + "\", cycle = \"50ms\", " + settings + " }\n";
  }
  Dslr camera;
  twin::dslr::PtpIpServer server{camera};
};

// Closes the contacts of the bodies' remote sockets.
class Line final : public Trigger {
 public:
  Line(std::vector<Dslr*> bodies, int& to_fail, int& fired, Clock& clock)
      : bodies_(std::move(bodies)), to_fail_(to_fail), fired_(fired), clock_(clock) {}
  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    if (to_fail_ > 0) {
      --to_fail_;
      return fail(Errc::kLost, "the line is unplugged");
    }
    const MonoTime at = clock_.mono();
    for (Dslr* body : bodies_) EXPECT_TRUE(body->pressShutter());
    ++fired_;
    return at;
  }
  Result<void> recover() override { return {}; }

 private:
  std::string id_ = "line";
  std::vector<Dslr*> bodies_;
  int &to_fail_, &fired_;
  Clock& clock_;
};

class SessionOnBodies : public ::testing::Test {
 protected:
  void run(const std::string& rig_toml, std::unique_ptr<Trigger> line, int steps) {
    const RigSpec spec = parseRig("name = \"bench\"\n" + rig_toml, folder_ / "rig.toml");
    const capture::Plan plan = capture::parsePlan(
        "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"4s\"\nduration = \"" +
            std::to_string(4 * steps) +
            "s\"\n[[sweep]]\nlights = [[]]\nexposures = [\"1/100\"]\n"
            "[light_check]\nmode = \"uncontrolled\"\n",
        folder_ / "plan.toml");
    db::ArchiveOptions options;
    options.folder = folder_ / "archive";
    options.owner = "test";
    db::Archive archive(options);
    const auto start = capture::startRun(plan, spec, archive, clock_, {});
    run_id_ = start.run_id;
    RigSpec cameras = spec;
    cameras.triggers.clear();
    Rig rig = rig::openHosted(cameras, {}, clock_, {std::getenv("PATINA_PROGRAM"), "device-host"});
    rig.spec = spec;
    if (line) rig.triggers.push_back(std::move(line));
    summary_ = capture::runSession(plan, rig, archive, clock_, start, hooks_);
    Progress progress;
    for (const auto& p : db::verify(folder_ / "archive", progress).problems)
      ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
  }
  std::unique_ptr<Trigger> line(std::vector<Dslr*> bodies) {
    return std::make_unique<Line>(std::move(bodies), line_fails_, fired_, clock_);
  }

  TempFolder folder_ = TempFolder::inMemory();
  RealClock clock_;
  capture::SessionHooks hooks_;
  int line_fails_ = 0, fired_ = 0;
  std::string run_id_;
  capture::SessionSummary summary_;
};

constexpr const char* kLineTable =
    "[[trigger]]\nid = \"line\"\nbackend = \"gpio\"\naddress = \"chip:17\"\n"
    "cameras = [\"cam0\", \"cam1\"]\n";

TEST_F(SessionOnBodies, CamerasThatWaitForALineAreFiredTogetherAndByNothingElse) {
  Body left(clock_, "1001"), right(clock_, "1002");
  const std::string waiting = "format = \"jpeg\", shutter = \"external\"";
  run(left.table("cam0", waiting) + right.table("cam1", waiting) + kLineTable,
      line({&left.camera, &right.camera}), 2);
  EXPECT_EQ(summary_.last.captured, 2);
  EXPECT_EQ(fired_, 2);
  std::map<db::RowId, std::vector<MonoTime>> began;
  const db::ArchiveReader reader(folder_ / "archive");
  reader.eachFrame(run_id_, [&](const db::ArchiveReader::CapturedFrame& row) {
    began[row.step.id].push_back(row.shot.began_mono);
  });
  ASSERT_EQ(began.size(), 2u);
  for (const auto& [step, times] : began) {
    ASSERT_EQ(times.size(), 2u);
    EXPECT_EQ(times[0], times[1]);  // the line's moment, not the drivers'
  }
  for (const Body* body : {&left, &right}) {
    EXPECT_EQ(body->camera.truth().shutter_count, 2u);
    const auto truth = body->camera.truth();
    for (const auto& picture : truth.pictures) EXPECT_FALSE(picture.stale);
  }
}

TEST_F(SessionOnBodies, ALineThatFailsCostsAnAttemptAndNoStep) {
  Body body(clock_, "1001");
  line_fails_ = 2;  // once, and once more after its recovery
  run(body.table("cam0", "format = \"jpeg\", shutter = \"external\"") +
          "[[trigger]]\nid = \"line\"\nbackend = \"gpio\"\naddress = \"chip:17\"\n"
          "cameras = [\"cam0\"]\n",
      line({&body.camera}), 2);
  EXPECT_EQ(summary_.last.captured, 2);
  const db::ArchiveReader reader(folder_ / "archive");
  const auto step = reader.step(run_id_, 0);
  EXPECT_GT(step->retries, 0);
  EXPECT_EQ(body.camera.truth().shutter_count, 2u);
  const auto verdict = judge(folder_ / "archive", {run_id_}, body.camera.truth(), {}, 20ms);
  EXPECT_THAT(verdict.broken, ::testing::IsEmpty());
}

// Somebody turns the dial from RAW+JPEG to RAW between two steps.
TEST_F(SessionOnBodies, APairOfWhichOneFileIsMissingIsNoFrameAndIsShotAgain) {
  Body body(clock_, "1001");
  hooks_.on_step = [&](const db::StepRow& step) {
    if (step.number == 0) body.camera.set(twin::dslr::Property::kCompression, twin::dslr::kRawOnly);
  };
  run(body.table("cam0", "format = \"raw+jpeg\", raw_extension = \"dng\""), {}, 3);
  const db::ArchiveReader reader(folder_ / "archive");
  for (const auto& step : reader.steps(run_id_)) {
    SCOPED_TRACE(step.number.value_or(-1));
    const auto frames = reader.framesOfStep(step.id);
    EXPECT_EQ(frames.size(), step.shots_captured == 1 ? 2u : 0u);  // whole, or nothing
    for (std::size_t i = 0; i < frames.size(); ++i)
      EXPECT_EQ(frames[i].ext, frames[i].file_index == 0 ? "dng" : "jpg");
  }
  EXPECT_GE(summary_.last.captured, 2);
  EXPECT_THAT(
      judge(folder_ / "archive", {run_id_}, body.camera.truth(), {"key", "fill"}, 1ms).broken,
      ::testing::IsEmpty());
}

}  // namespace
}  // namespace patina::testing
