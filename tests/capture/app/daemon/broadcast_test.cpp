// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/broadcast.h"

#include <gmock/gmock.h>

#include "tests/capture/app/daemon/live_view.h"

namespace patina::daemon {
namespace {

using capture::AlertEvent;
using capture::AlertKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class BroadcastTest : public ::testing::Test {
 protected:
  BroadcastTest() {
    broadcast_.publishTo([this](const std::string& event, const std::string& json) {
      names_.push_back(event);
      last_ = json;
    });
  }
  void alert(capture::AlertEvent event, capture::AlertKind kind, const std::string& subject,
             const std::string& detail = "why") {
    capture::AlertNews news;
    news.event = event;
    news.kind = kind;
    news.subject = subject;
    news.detail = detail;
    news.since_utc = utcFromNs(5);
    broadcast_.onAlert("r", news);
  }
  devices::VirtualClock clock_{parseUtc("2024-05-01T12:00:00Z")};
  http::Metrics metrics_;
  Watchdog watchdog_{clock_};
  Broadcast broadcast_{metrics_, watchdog_};
  std::vector<std::string> names_;
  std::string last_;
};

TEST_F(BroadcastTest, EveryStepVerdictAlertAndFrameIsAnEvent) {
  broadcast_.onStep({});
  const std::vector<db::LightCheckRow> checks(1);
  broadcast_.onLight(checks);
  alert(AlertEvent::kBegins, AlertKind::kCameraDown, "cam0");
  broadcast_.onFrame("r", "cam0", {});
  broadcast_.onStatus(liveView());
  broadcast_.onRun(liveView());
  EXPECT_THAT(names_, ElementsAre("step", "light", "alert", "frame", "status", "run"));
}

TEST_F(BroadcastTest, AnAlertIsOnFromItsBeginningToItsEnd) {
  alert(AlertEvent::kBegins, AlertKind::kCameraDown, "cam0", "timeout");
  alert(AlertEvent::kReminder, AlertKind::kCameraDown, "cam0", "timeout");
  ASSERT_THAT(broadcast_.alerts(), SizeIs(1));
  EXPECT_EQ(broadcast_.alerts()[0].what, "camera cam0 down");
  EXPECT_EQ(broadcast_.alerts()[0].detail, "timeout");
  EXPECT_EQ(broadcast_.alerts()[0].since, utcFromNs(5));
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_alerts_active 1"));
  alert(AlertEvent::kOver, AlertKind::kCameraDown, "cam0");
  EXPECT_THAT(broadcast_.alerts(), IsEmpty());
  EXPECT_THAT(last_, HasSubstr("\"over\":true"));
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_alerts_active 0"));
}

TEST_F(BroadcastTest, ARunThatHasEndedLeavesNoAlert) {
  alert(AlertEvent::kBegins, AlertKind::kLampDead, "key");
  RunView ended = liveView();
  ended.id = "r";
  ended.active = false;
  broadcast_.onRun(ended);
  EXPECT_THAT(broadcast_.alerts(), IsEmpty());
}

TEST_F(BroadcastTest, CountsWhatBecomesOfStepsAndShots) {
  db::StepRow step;
  step.run_id = "r";
  step.decision = db::Decision::kCaptured;
  broadcast_.onStep(step);
  broadcast_.onStep(step);
  db::ShotRow shot;
  shot.device_id = "cam0";
  shot.state = db::ShotState::kFailed;
  broadcast_.onShot(shot);
  broadcast_.onStatus(liveView());
  broadcast_.committed(std::chrono::milliseconds(30));
  const std::string text = metrics_.text();
  EXPECT_THAT(text, HasSubstr("decision=\"captured\"} 2"));
  EXPECT_THAT(text, HasSubstr("patina_frames_total{camera=\"cam0\",result=\"failed\"} 1"));
  EXPECT_THAT(text, HasSubstr("patina_camera_up{camera=\"cam1\"} 0"));
  EXPECT_THAT(text, HasSubstr("patina_commit_seconds_count 1"));
}

TEST_F(BroadcastTest, CountsEachStepsLatenessOnceAndTheRungsThatWereTaken) {
  db::StepRow step;
  step.run_id = liveView().id;
  step.number = 3;
  step.decision = db::Decision::kCaptured;
  RunView view = liveView();
  view.status.late = std::chrono::milliseconds(4);
  broadcast_.onStep(step);
  broadcast_.onStatus(view);
  broadcast_.onStatus(view);
  step.decision = db::Decision::kSkipped;
  broadcast_.onStep(step);
  broadcast_.onStatus(view);
  broadcast_.onEvent({1, "r", utcFromNs(5), "recover", "cam0: reopen after timeout: x"});
  const std::string text = metrics_.text();
  EXPECT_THAT(text, HasSubstr("patina_slot_late_seconds_count 1"));
  EXPECT_THAT(text, HasSubstr("patina_slot_late_seconds_bucket{le=\"0.005\"} 1"));
  EXPECT_THAT(text, HasSubstr("patina_camera_resets_total{camera=\"cam0\",step=\"reopen\"} 1"));
}

TEST_F(BroadcastTest, ReadsNoAlertOutOfTheTextOfAnEvent) {
  broadcast_.onEvent({1, "r", utcFromNs(5), "alarm", "camera cam0 down begins: timeout"});
  EXPECT_THAT(broadcast_.alerts(), IsEmpty());
}

TEST_F(BroadcastTest, WhatBelongsToNoRunStaysWhenARunEnds) {
  broadcast_.warn("products of r failed", "exit 74", utcFromNs(5));
  broadcast_.damaged("hash frames/ab/cd.jpg", utcFromNs(6));
  RunView ended = liveView();
  ended.id = "r";
  ended.active = false;
  broadcast_.onRun(ended);
  EXPECT_THAT(broadcast_.alerts(), SizeIs(2));
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_scrub_errors_total 1"));
  broadcast_.settled("products of r failed");
  broadcast_.settled("products of r failed");
  ASSERT_THAT(broadcast_.alerts(), SizeIs(1));
  EXPECT_EQ(broadcast_.alerts()[0].what, "archive damaged");
  EXPECT_EQ(broadcast_.alerts()[0].detail, "hash frames/ab/cd.jpg");
}

TEST_F(BroadcastTest, PredictsWhenTheDiskIsFullByTheWorstOfTheForecasts) {
  RunView view = liveView();
  view.status.disk_full_utc = view.status.now_utc + std::chrono::hours(2);
  broadcast_.onStatus(view);
  RunView other = liveView();
  other.id = "other";
  other.status.disk_full_utc = other.status.now_utc + std::chrono::hours(1);
  broadcast_.onStatus(other);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_store_predicted_full_seconds 3600"));
  other.active = false;
  broadcast_.onRun(other);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_store_predicted_full_seconds 7200"));
  view.status.disk_full_utc.reset();
  broadcast_.onStatus(view);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_store_predicted_full_seconds +Inf"));
}

TEST_F(BroadcastTest, ARunIsActiveWhileItsSessionIsAtWorkAndNotPaused) {
  broadcast_.onSession("r", Phase::kBegins);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_run_active{run=\"r\"} 1"));
  RunView paused = liveView();
  paused.id = "r";
  paused.status.paused = true;
  broadcast_.onStatus(paused);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_run_active{run=\"r\"} 0"));
  broadcast_.onSession("r", Phase::kEnds);
  EXPECT_THAT(metrics_.text(), HasSubstr("patina_run_active{run=\"r\"} 0"));
}

TEST_F(BroadcastTest, WithoutAServerItIsSilent) {
  broadcast_.publishTo({});
  broadcast_.onStep({});
  EXPECT_THAT(names_, IsEmpty());
}

}  // namespace
}  // namespace patina::daemon
