// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/metrics.h"

#include <gtest/gtest.h>

#include <thread>

namespace patina::http {
namespace {

TEST(Metrics, PrintsOnlyWhatWasAskedFor) {
  Metrics metrics;
  EXPECT_EQ(metrics.text(), "");
  metrics.counter("patina_frames_total", {"left", "captured"}).add(3);
  EXPECT_EQ(metrics.text(),
            "# HELP patina_frames_total Frames by what became of them.\n"
            "# TYPE patina_frames_total counter\n"
            "patina_frames_total{camera=\"left\",result=\"captured\"} 3\n");
}

TEST(Metrics, EscapesWhatWouldEndALabel) {
  Metrics metrics;
  metrics.gauge("patina_camera_up", {"a\"b\\c\nd"}).set(1);
  EXPECT_NE(metrics.text().find("patina_camera_up{camera=\"a\\\"b\\\\c\\nd\"} 1\n"),
            std::string::npos);
}

TEST(Metrics, CountsAHistogramUpToEachBound) {
  Metrics metrics;
  Histogram& late = metrics.histogram("patina_slot_late_seconds");
  for (const double s : {0.0005, 0.001, 0.003, 100.0}) late.observe(s);
  const std::string text = metrics.text();
  EXPECT_NE(text.find("patina_slot_late_seconds_bucket{le=\"0.001\"} 2\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("patina_slot_late_seconds_bucket{le=\"0.005\"} 3\n"), std::string::npos);
  EXPECT_NE(text.find("patina_slot_late_seconds_bucket{le=\"+Inf\"} 4\n"), std::string::npos);
  EXPECT_NE(text.find("patina_slot_late_seconds_count 4\n"), std::string::npos);
  EXPECT_NE(text.find("patina_slot_late_seconds_sum 100.0045\n"), std::string::npos);
}

TEST(Metrics, LosesNoUpdateOfSeveralThreads) {
  Metrics metrics;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&metrics] {
      for (int i = 0; i < 10'000; ++i) metrics.counter("patina_scrub_errors_total").add();
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(metrics.counter("patina_scrub_errors_total").value(), 40'000);
}

TEST(Metrics, PutsTheSeriesOfAFloodOfLabelsTogether) {
  Metrics metrics;
  for (int i = 0; i < 1000; ++i) metrics.counter("patina_dropped_total", {std::to_string(i)}).add();
  EXPECT_EQ(metrics.counter("patina_dropped_total", {"other"}).value(), 744);
  EXPECT_LT(metrics.text().size(), 20'000u);
}

TEST(Metrics, AsksItsCollectorsBeforeItPrints) {
  Metrics metrics;
  metrics.beforeText([](Metrics& m) { m.gauge("patina_outbox_depth").set(7); });
  EXPECT_NE(metrics.text().find("patina_outbox_depth 7\n"), std::string::npos);
}

TEST(MetricsDeathTest, KnowsNoNameThatNoFamilyHas) {
  Metrics metrics;
  EXPECT_DEATH(metrics.counter("patina_nonsense"), "families_");
  EXPECT_DEATH(metrics.gauge("patina_frames_total", {"a", "b"}), "kind");
  EXPECT_DEATH(metrics.counter("patina_frames_total", {"a"}), "labels");
}

}  // namespace
}  // namespace patina::http
