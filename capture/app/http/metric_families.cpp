// SPDX-License-Identifier: GPL-3.0-or-later
// What the daemon exports, by name.
#include "capture/app/http/metrics.h"

namespace patina::http {
namespace {

constexpr MetricKind kCounter = MetricKind::kCounter, kGauge = MetricKind::kGauge,
                     kHistogram = MetricKind::kHistogram;

std::vector<MetricFamily> captureFamilies() {
  return {
      {"patina_up", "1 while the daemon runs.", kGauge, {}, {}},
      {"patina_run_active",
       "1 while the run is to shoot: neither paused nor over.",
       kGauge,
       {"run"},
       {}},
      {"patina_interval_seconds", "Interval of the run's plan.", kGauge, {"run"}, {}},
      {"patina_last_ack_timestamp_seconds",
       "UTC of the run's last acknowledged frame.",
       kGauge,
       {"run"},
       {}},
      {"patina_frames_total", "Frames by what became of them.", kCounter, {"camera", "result"}, {}},
      {"patina_steps_total", "Steps by decision.", kCounter, {"run", "decision"}, {}},
      {"patina_slot_late_seconds",
       "From the due time of a step to its first trigger.",
       kHistogram,
       {},
       {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, 1, 5, 30}},
      {"patina_commit_seconds",
       "From the bytes of a frame to its acknowledgement.",
       kHistogram,
       {},
       {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10}},
      {"patina_camera_up", "1 while the camera answers.", kGauge, {"camera"}, {}},
      {"patina_camera_resets_total",
       "Rungs of the recovery ladder that were taken.",
       kCounter,
       {"camera", "step"},
       {}},
      {"patina_light_level_ratio",
       "Level of a light over its level at the start of the run.",
       kGauge,
       {"light"},
       {}},
      {"patina_clock_steps_total", "Times the wall clock jumped.", kCounter, {}, {}},
      {"patina_store_free_bytes", "Free space on the disk of the archive.", kGauge, {}, {}},
      {"patina_store_predicted_full_seconds",
       "Until captures stop for want of room, by the plans of the runs; +Inf: all fit.",
       kGauge,
       {},
       {}},
      {"patina_dropped_total",
       "What was given up rather than waited for.",
       kCounter,
       {"reason"},
       {}},
      {"patina_outbox_depth", "Rows that wait to be replicated.", kGauge, {}, {}},
      {"patina_scrub_errors_total",
       "Files of the archive that no longer match their hash.",
       kCounter,
       {},
       {}},
      {"patina_alerts_active", "Alerts that are on.", kGauge, {}, {}},
  };
}

std::vector<MetricFamily> serverFamilies() {
  return {
      {"patina_http_requests_total", "Answers by status.", kCounter, {"status"}, {}},
      {"patina_http_connections", "Open connections.", kGauge, {}, {}},
      {"patina_http_late_total",
       "Connections closed because they were too slow.",
       kCounter,
       {},
       {}},
      {"patina_http_streams", "Open event streams.", kGauge, {}, {}},
      {"patina_http_events_total", "Events published.", kCounter, {}, {}},
      {"process_cpu_seconds_total", "User and system CPU time.", kCounter, {}, {}},
      {"process_resident_memory_bytes", "Resident memory.", kGauge, {}, {}},
      {"process_virtual_memory_bytes", "Virtual memory.", kGauge, {}, {}},
      {"process_open_fds", "Open file descriptors.", kGauge, {}, {}},
      {"process_max_fds", "The most file descriptors that may be open.", kGauge, {}, {}},
      {"process_threads", "Threads.", kGauge, {}, {}},
      {"process_start_time_seconds", "UTC of the start.", kGauge, {}, {}},
  };
}

std::vector<MetricFamily> allFamilies() {
  auto families = captureFamilies();
  for (MetricFamily& family : serverFamilies()) families.push_back(std::move(family));
  return families;
}

}  // namespace

const std::vector<MetricFamily>& metricFamilies() {
  static const std::vector<MetricFamily> families = allFamilies();
  return families;
}

}  // namespace patina::http
